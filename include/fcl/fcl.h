// SPDX-License-Identifier: BSD-3-Clause
//
// FCL's own <fcl/fcl.h>, which finds the headers of this package first. It stands here
// for programs that look for FCL's headers by this name, as with CMake's find_path().
// This is a system header, since #include_next is an extension.
//
// It has no include guard, since FCL's header has one: if two folders on the include path
// have this header, each passes on to the next one.
#pragma GCC system_header

#include_next <fcl/fcl.h>

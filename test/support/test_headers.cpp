// SPDX-License-Identifier: BSD-3-Clause
//
// Compiled with the headers that tests share; see test/CMakeLists.txt.

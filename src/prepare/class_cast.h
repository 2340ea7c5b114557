// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_PREPARE_CLASS_CAST_H
#define FCL_CCD_PREPARE_CLASS_CAST_H

#include <typeinfo>

#include "fcl/narrowphase/detail/query_numbers.h"

namespace fcl {
namespace detail {

/// @brief dynamic_cast of an object of the program. Null also for a class that was
/// compiled with -fno-rtti, which dynamic_cast cannot read.
template <typename To, typename From>
const To* classCast(const From& object) {
  return typeInfoOf(&object) ? dynamic_cast<const To*>(&object) : nullptr;
}

/// @brief Whether the class of an object is exactly this one.
template <typename Class, typename Base>
bool isExactly(const Base& object) {
  const std::type_info* type = typeInfoOf(&object);
  return type && *type == typeid(Class);
}

}  // namespace detail
}  // namespace fcl

#endif

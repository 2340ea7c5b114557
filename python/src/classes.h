// SPDX-License-Identifier: BSD-3-Clause
//
// Classes of the Python module.
#ifndef FCL_CCD_PYTHON_CLASSES_H
#define FCL_CCD_PYTHON_CLASSES_H

#include <pybind11/pybind11.h>

#include <cstddef>
#include <string>

namespace fcl_ccd {
namespace python {

/// A class of Python whose objects are used only after __init__(). Python makes objects
/// without it: cls.__new__(cls), or a class of the user that uses its base before it
/// calls the base's __init__(). While __init__() runs, other threads see them too.
///
/// pybind11 gives such an object memory that nobody has initialised, and goes on. It asks
/// operator_new of the class for this memory, and for nothing else: here it is a
/// TypeError.
template <typename Object, typename... Options>
class Class : public pybind11::class_<Object, Options...> {
 public:
  Class(pybind11::module_& module, const char* name)
      : pybind11::class_<Object, Options...>(module, name) {
    pybind11::detail::get_type_info(typeid(Object))->operator_new = &refuseUse;
    this->def("__reduce_ex__", &refuseCopy);
  }

 private:
  static std::string nameOf(const pybind11::handle& type) {
    return pybind11::cast<std::string>(type.attr("__name__"));
  }

  [[noreturn]] static void* refuseUse(std::size_t) {
    throw pybind11::type_error("the __init__() of this " +
                               nameOf(pybind11::type::of<Object>()) +
                               " was not called, or has not ended");
  }

  /// @param self  also an object that is not initialised
  [[noreturn]] static void refuseCopy(const pybind11::handle& self, int /*protocol*/) {
    throw pybind11::type_error("a " + nameOf(pybind11::type::handle_of(self)) +
                               " cannot be copied or pickled. Make another one");
  }
};

}  // namespace python
}  // namespace fcl_ccd

#endif

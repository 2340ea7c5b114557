// SPDX-License-Identifier: BSD-3-Clause
//
// Classes of the Python module.
#ifndef FCL_CCD_PYTHON_CLASSES_H
#define FCL_CCD_PYTHON_CLASSES_H

#include <pybind11/pybind11.h>

#include <cstddef>
#include <memory>
#include <string>
#include <utility>

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
  /// @param extra  options of pybind11
  template <typename... Extra>
  Class(pybind11::module_& module, const char* name, const Extra&... extra)
      : pybind11::class_<Object, Options...>(module, name, extra...) {
    pybind11::detail::get_type_info(typeid(Object))->operator_new = &refuseUse;
    this->def("__reduce_ex__", &refuseCopy);
  }

  /// A constructor without Python's lock (the GIL), which two threads may call for one
  /// object.
  template <typename... Arguments, typename... Names>
  Class& defInit(const Names&... names) {
    const auto init = [](pybind11::detail::value_and_holder& self,
                         Arguments... arguments) {
      auto built = std::make_unique<Object>(std::forward<Arguments>(arguments)...);
      if (self.value_ptr())
        throw pybind11::type_error("another thread has called this __init__()");
      self.value_ptr() = built.release();
    };
    this->def("__init__", init, pybind11::detail::is_new_style_constructor(), names...);
    return *this;
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

/// The C++ object of an object of Python. Null: it is not built, or its class has more
/// than one base of this module.
template <typename Object>
const Object* builtObject(PyObject* self) {
  const auto& instance = *reinterpret_cast<pybind11::detail::instance*>(self);
  if (!instance.simple_layout || !instance.simple_holder_constructed) return nullptr;
  return static_cast<const Object*>(instance.simple_value_holder[0]);
}

/// Shows Python's garbage collector what objects of a class refer to, so that cycles with
/// objects of the user are freed. There is no tp_clear, as in a tuple: these objects do
/// not change, and in each cycle there is one that does.
/// @tparam Object  its visit(visit) calls visit(pybind11::handle) for each reference
template <typename Object>
pybind11::custom_type_setup seenByCollector() {
  return pybind11::custom_type_setup([](PyHeapTypeObject* heap_type) {
    PyTypeObject& type = heap_type->ht_type;
    type.tp_flags |= Py_TPFLAGS_HAVE_GC;
    type.tp_traverse = [](PyObject* self, visitproc visit, void* arg) {
#if PY_VERSION_HEX >= 0x03090000
      Py_VISIT(Py_TYPE(self));
#endif
      int stop = 0;
      if (const auto* object = builtObject<Object>(self))
        object->visit([&](const pybind11::handle& reference) {
          if (stop == 0 && reference) stop = visit(reference.ptr(), arg);
        });
      return stop;
    };
    type.tp_dealloc = [](PyObject* self) {
      PyObject_GC_UnTrack(self);
      pybind11::detail::pybind11_object_dealloc(self);
    };
  });
}

}  // namespace python
}  // namespace fcl_ccd

#endif

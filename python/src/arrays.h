// SPDX-License-Identifier: BSD-3-Clause
//
// Numpy arrays in and out. The Python part of the package checks shapes and types, and
// says what is wrong. The checks here keep memory safe if it is left out.
#ifndef FCL_CCD_PYTHON_ARRAYS_H
#define FCL_CCD_PYTHON_ARRAYS_H

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace fcl_ccd {
namespace python {

namespace py = pybind11;

/// Contiguous numbers in C order. A contiguous array of this type is not copied.
using Doubles = py::array_t<double, py::array::c_style>;
using Integers = py::array_t<std::int64_t, py::array::c_style>;

inline void requireSize(const py::array& array, std::size_t size, const char* name) {
  if (static_cast<std::size_t>(array.size()) != size)
    throw py::value_error(std::string(name) + " has " + std::to_string(array.size()) +
                          " numbers instead of " + std::to_string(size));
}

/// Byte offset of a member. offsetof() is defined for fewer types.
template <typename Record, typename Member>
py::ssize_t offsetOf(Member Record::*member) {
  const Record record{};
  return reinterpret_cast<const char*>(&(record.*member)) -
         reinterpret_cast<const char*>(&record);
}

/// The description of a C++ record for numpy, field by field. It names no field twice and
/// may leave out members.
template <typename Record>
class RecordType {
 public:
  /// @param format  numpy's name of the type, for example "<f8" or "(3,)<f8"
  template <typename Member>
  RecordType& field(const char* name, const char* format, Member Record::*member) {
    names_.append(name);
    formats_.append(format);
    offsets_.append(offsetOf(member));
    return *this;
  }

  py::dtype dtype() const {
    return py::dtype(names_, formats_, offsets_,
                     static_cast<py::ssize_t>(sizeof(Record)));
  }

 private:
  py::list names_, formats_, offsets_;
};

/// Specialised for each record that becomes an element of an array.
template <typename Record>
py::dtype makeDtype();

/// The type is made once and is never freed, like numpy itself.
template <typename Record>
const py::dtype& dtypeOf() {
  static const auto* dtype = new py::dtype(makeDtype<Record>());
  return *dtype;
}

/// Gives the records to an array without a copy.
template <typename Record>
py::array toArray(std::vector<Record>&& records) {
  auto owner = std::make_unique<std::vector<Record>>(std::move(records));
  const auto count = static_cast<py::ssize_t>(owner->size());
  Record* data = owner->data();
  const py::capsule base(owner.get(),
                         [](void* p) { delete static_cast<std::vector<Record>*>(p); });
  owner.release();
  return py::array(dtypeOf<Record>(), {count}, {static_cast<py::ssize_t>(sizeof(Record))},
                   data, base);
}

}  // namespace python
}  // namespace fcl_ccd

#endif

// SPDX-License-Identifier: BSD-3-Clause
//
// Requests and answers of queries for contacts.
#ifndef FCL_CCD_PYTHON_REQUESTS_H
#define FCL_CCD_PYTHON_REQUESTS_H

#include <atomic>
#include <exception>
#include <functional>

#include "arrays.h"
#include "fcl/narrowphase/continuous_contact.h"
#include "fcl/narrowphase/detail/query_numbers.h"

namespace fcl_ccd {
namespace python {

using Contacts = fcl::ContinuousContacts<double>;
using Outcome = fcl::detail::QueryOutcome<double>;

/// A request without its function of Python, which belongs to one call.
struct Request {
  fcl::detail::QuerySettings settings{};
  fcl::ContinuousFilter filter1, filter2;
  py::object accepts_triangles;
};

/// The function of Python that accepts pairs of triangles. The threads of a query call it
/// in turn, since it needs the GIL. After its first exception it is not called again, and
/// the exception reaches the caller when the query has ended.
class TriangleFilter {
 public:
  /// @param function  None: accepts all
  explicit TriangleFilter(const py::object& function) {
    if (function.is_none()) return;
    call_ = [this, &function](std::intptr_t b1, std::intptr_t b2) {
      return ask(function, b1, b2);
    };
  }

  /// Null: all pairs are accepted.
  const std::function<bool(std::intptr_t, std::intptr_t)>* function() const {
    return call_ ? &call_ : nullptr;
  }

  /// Runs a query. The caller does not have the GIL.
  template <typename Query>
  void run(Query&& query) {
    try {
      query();
    } catch (...) {
      if (!failed_) throw;
    }
    if (failed_) std::rethrow_exception(error_);
  }

 private:
  bool ask(const py::object& function, std::intptr_t b1, std::intptr_t b2) {
    if (failed_) return false;
    const py::gil_scoped_acquire acquire;
    try {
      const int answer = PyObject_IsTrue(function(b1, b2).ptr());
      if (answer < 0) throw py::error_already_set();
      return answer == 1;
    } catch (py::error_already_set&) {
      if (!failed_) error_ = std::current_exception();
      failed_ = true;
      return false;
    }
  }

  std::function<bool(std::intptr_t, std::intptr_t)> call_;
  std::atomic<bool> failed_{false};
  std::exception_ptr error_;
};

/// The fields of the class Result of Python.
py::dict fieldsOf(const Outcome& outcome, Contacts&& contacts);

}  // namespace python
}  // namespace fcl_ccd

#endif

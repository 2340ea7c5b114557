// SPDX-License-Identifier: BSD-3-Clause
//
// Requests and answers of queries for contacts.
#ifndef FCL_CCD_PYTHON_REQUESTS_H
#define FCL_CCD_PYTHON_REQUESTS_H

#include <atomic>
#include <exception>
#include <optional>

#include "arrays.h"
#include "fcl/narrowphase/continuous_contact.h"
#include "fcl/narrowphase/continuous_distance.h"
#include "fcl/narrowphase/detail/query_numbers.h"

namespace fcl_ccd {
namespace python {

using Contacts = fcl::ContinuousContacts<double>;
using Outcome = fcl::detail::QueryOutcome<double>;

/// A request without its function of Python, which belongs to one call.
struct Request {
  fcl::ContinuousContactRequestd fields;
  py::object accepts_triangles;
};

/// A request for the least distance. What it shares with one for contacts is in
/// `contacts`.
struct DistanceRequest {
  Request contacts;
  double abs_err, rel_err, max_distance;

  /// @param contacts  with the function that accepts triangles
  fcl::ContinuousDistanceRequestd of(
      const fcl::ContinuousContactRequestd& contacts) const;
};

/// The function of Python that accepts pairs of triangles. The threads of a query call it
/// in turn, since it needs the GIL. After its first exception it is not called again, and
/// the exception reaches the caller when the query has ended.
class TriangleFilter {
 public:
  /// @param request  must live as long as this; without a function all are accepted
  explicit TriangleFilter(const Request& request) : request_(request.fields) {
    if (request.accepts_triangles.is_none()) return;
    own_ = request.fields;
    own_->accepts_triangles = [this, &request](std::intptr_t b1, std::intptr_t b2) {
      return ask(request.accepts_triangles, b1, b2);
    };
  }

  /// The request with the function.
  const fcl::ContinuousContactRequestd& request() const {
    return own_ ? *own_ : request_;
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

  const fcl::ContinuousContactRequestd& request_;
  /// With the function; empty: there is none.
  std::optional<fcl::ContinuousContactRequestd> own_;
  std::atomic<bool> failed_{false};
  std::exception_ptr error_;
};

/// The fields of the class Result of Python.
py::dict fieldsOf(const Outcome& outcome, Contacts&& contacts);

/// The fields of the class DistanceResult of Python.
py::dict fieldsOf(const fcl::ContinuousDistanceResultd& found);

}  // namespace python
}  // namespace fcl_ccd

#endif

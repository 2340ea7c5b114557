// SPDX-License-Identifier: BSD-3-Clause
#include "fcl/narrowphase/continuous_features.h"

#include <array>
#include <string>

#include "arrays.h"
#include "errors.h"
#include "fcl/common/exception.h"
#include "fcl/narrowphase/continuous_candidates.h"
#include "meshes.h"
#include "motions.h"
#include "queries.h"

namespace fcl_ccd {
namespace python {

using Candidate = fcl::ContinuousCandidate;
using FeatureTestResult = fcl::ContinuousFeatureTestResult<double>;

template <>
py::dtype makeDtype<Candidate>() {
  return RecordType<Candidate>()
      .field("kind", "<i4", &Candidate::kind)
      .field("first_on_o1", "?", &Candidate::first_on_o1)
      .field("vertices", "(4,)<i4", &Candidate::vertices)
      .field("b1", "<i8", &Candidate::b1)
      .field("b2", "<i8", &Candidate::b2)
      .field("window_lo", "<f8", &Candidate::window_lo)
      .field("window_hi", "<f8", &Candidate::window_hi)
      .dtype();
}

template <>
py::dtype makeDtype<FeatureTestResult>() {
  return RecordType<FeatureTestResult>()
      .field("is_contact", "?", &FeatureTestResult::is_contact)
      .field("toc_lo", "<f8", &FeatureTestResult::toc_lo)
      .field("toc_hi", "<f8", &FeatureTestResult::toc_hi)
      .dtype();
}

namespace {

using fcl::Vector3d;

/// Collects candidates, and hands them to a function of Python in blocks.
class Blocks {
 public:
  Blocks(const py::object& sink, std::size_t block_size)
      : sink_(sink), block_size_(block_size) {}

  /// Called without the GIL.
  bool take(const Candidate* candidates, std::size_t count) {
    block_.insert(block_.end(), candidates, candidates + count);
    return block_.size() < block_size_ || handOut();
  }

  bool handOut() {
    const py::gil_scoped_acquire acquire;
    std::vector<Candidate> block;
    block.swap(block_);
    const py::object answer = sink_(toArray(std::move(block)));
    if (answer.is_none()) return true;
    const int goes_on = PyObject_IsTrue(answer.ptr());
    if (goes_on < 0) throw py::error_already_set();
    return goes_on == 1;
  }

  bool isEmpty() const { return block_.empty(); }

 private:
  const py::object& sink_;
  std::size_t block_size_;
  std::vector<Candidate> block_;
};

/// Runs query(sink) and hands its candidates to Python. Called with the GIL.
/// @return false when Python ended the query
template <typename Query>
bool handOut(const py::object& sink, std::size_t block_size, const Query& query) {
  Blocks blocks(sink, block_size);
  const py::gil_scoped_release release;
  const bool all = query([&](const Candidate* candidates, std::size_t count) {
    return blocks.take(candidates, count);
  });
  return all && (blocks.isEmpty() || blocks.handOut());
}

bool selfCandidates(const Mesh& o, const py::object& sink, std::size_t block_size,
                    double min_distance) {
  const Geometry::Reading reading(o);
  return handOut(sink, block_size, [&](const auto& take) {
    return fcl::detail::answerSelfCandidates(&o.geometry(), take, min_distance);
  });
}

bool candidates(const Mesh& o1, const Motion& motion1, const Mesh& o2,
                const Motion& motion2, const py::object& sink, std::size_t block_size,
                double min_distance) {
  const Geometry::Reading reading1(o1), reading2(o2);
  return handOut(sink, block_size, [&](const auto& take) {
    return fcl::detail::answerCandidates(motion1.of(o1.geometry()),
                                         motion2.of(o2.geometry()), take, min_distance);
  });
}

template <std::size_t num_points>
using Points = std::array<Vector3d, num_points>;

template <std::size_t num_points>
Points<num_points> pointsAt(const double* x) {
  Points<num_points> points;
  for (Vector3d& point : points) {
    point = Vector3d(x[0], x[1], x[2]);
    x += 3;
  }
  return points;
}

/// Runs a test of num_points points for each query.
/// @param t0, t1  n x num_points x 3
template <std::size_t num_points, typename Test>
py::array testAll(const Doubles& t0, const Doubles& t1, const Test& test) {
  constexpr std::size_t kNumbers = 3 * num_points;
  const auto count = static_cast<std::size_t>(t0.size()) / kNumbers;
  requireSize(t0, kNumbers * count, "t0");
  requireSize(t1, kNumbers * count, "t1");
  std::vector<FeatureTestResult> results;
  {
    const py::gil_scoped_release release;
    results.reserve(count);
    for (std::size_t i = 0; i < count; ++i) try {
        results.push_back(test(pointsAt<num_points>(t0.data() + kNumbers * i),
                               pointsAt<num_points>(t1.data() + kNumbers * i)));
      } catch (const fcl::Exception& error) {
        throw py::value_error("query " + std::to_string(i) + ": " +
                              inPython(error.what()));
      }
  }
  return toArray(std::move(results));
}

py::array testVertexFaces(const Doubles& t0, const Doubles& t1, double toc_err,
                          double distance) {
  return testAll<4>(t0, t1, [&](const Points<4>& a, const Points<4>& b) {
    return fcl::vertexFaceWithin<double>(a[0], a[1], a[2], a[3], b[0], b[1], b[2], b[3],
                                         toc_err, distance);
  });
}

py::array testEdgeEdges(const Doubles& t0, const Doubles& t1, double toc_err,
                        double distance) {
  return testAll<4>(t0, t1, [&](const Points<4>& a, const Points<4>& b) {
    return fcl::edgeEdgeWithin<double>(a[0], a[1], a[2], a[3], b[0], b[1], b[2], b[3],
                                       toc_err, distance);
  });
}

py::array testVertexEdges(const Doubles& t0, const Doubles& t1, double toc_err,
                          double distance) {
  return testAll<3>(t0, t1, [&](const Points<3>& a, const Points<3>& b) {
    return fcl::vertexEdgeWithin<double>(a[0], a[1], a[2], b[0], b[1], b[2], toc_err,
                                         distance);
  });
}

py::array testVertexVertices(const Doubles& t0, const Doubles& t1, double toc_err,
                             double distance) {
  return testAll<2>(t0, t1, [&](const Points<2>& a, const Points<2>& b) {
    return fcl::vertexVertexWithin<double>(a[0], a[1], b[0], b[1], toc_err, distance);
  });
}

}  // namespace

void bindFeatures(py::module_& module) {
  module.attr("candidate_dtype") = dtypeOf<Candidate>();
  module.attr("feature_test_dtype") = dtypeOf<FeatureTestResult>();
  module.def("self_candidates", &selfCandidates);
  module.def("candidates", &candidates);
  module.def("vertex_face", &testVertexFaces);
  module.def("edge_edge", &testEdgeEdges);
  module.def("vertex_edge", &testVertexEdges);
  module.def("vertex_vertex", &testVertexVertices);
}

}  // namespace python
}  // namespace fcl_ccd

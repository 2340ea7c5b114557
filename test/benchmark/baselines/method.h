// SPDX-License-Identifier: BSD-3-Clause
//
// The methods to compare with, as choices that are independent of each other, so that
// what each of them brings can be measured alone.
#ifndef FCL_BENCHMARK_BASELINES_METHOD_H
#define FCL_BENCHMARK_BASELINES_METHOD_H

namespace fcl {
namespace test {

/// @brief How pairs of features are culled before any of them is tested. All techniques
/// have a binary tree of 16-DOPs and boxes of features.
enum class Technique {
  /// Hutter, Fuhrmann 2007: boxes of features and nothing else. Each pair of triangles
  /// tests all its features, so that a pair of features is tested wherever it is met.
  kFeatureBoxes,
  /// Curtis, Tamstorf, Manocha 2008, R-Triangles: a triangle represents the features that
  /// it owns.
  kRepresentatives,
  /// Tang, Curtis, Yoon, Manocha 2009, ICCD: normal cones with a contour test leave
  /// regions of the surface out, adjacent triangles only test what no other pair of
  /// triangles does (orphans), and the representative of a feature depends on what it is
  /// compared with.
  kConnectivity
};

enum class Boxes {
  kSwept,  ///< one around the whole motion, as in all these papers
  kMoving  ///< the library's: one at t = 0 and one at t = 1
};

enum class Filter {
  kNone,
  kPlain,     ///< Tang, Manocha, Tong 2010: signs of four numbers over the whole step
  kCertified  ///< the library's: signs with a bound, while the boxes overlap
};

enum class KernelSet {
  /// As in 2010: four floats at a time for boxes (the papers used SSE), one pair at a
  /// time for everything else.
  kScalar,
  /// The library's, for boxes of nodes and features and for the filter: the instructions
  /// that the processor has. Interval-Newton stays as it is.
  kVector
};

struct BaselineMethod {
  Technique technique;
  Filter filter{Filter::kNone};
  KernelSet kernels{KernelSet::kScalar};
  Boxes boxes{Boxes::kSwept};
};

}  // namespace test
}  // namespace fcl

#endif

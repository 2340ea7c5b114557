// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_FUZZ_PAIR_AS_TEST_H
#define FCL_FUZZ_PAIR_AS_TEST_H

#include <sstream>
#include <string>

#include "feature_pair_generators.h"

namespace fcl {
namespace test {

inline const char* kindName(fcl::ContinuousContactKind kind) {
  if (kind == fcl::ContinuousContactKind::kVertexFace) return "kVertexFace";
  if (kind == fcl::ContinuousContactKind::kEdgeEdge) return "kEdgeEdge";
  return kind == fcl::ContinuousContactKind::kVertexEdge ? "kVertexEdge"
                                                         : "kVertexVertex";
}

/// @brief The pair as code.
/// @param expected  what the test expects of the result
inline std::string asTest(const MovingPair& pair, double toc_err,
                          const std::string& expected) {
  std::ostringstream out;
  out << "  // test/unit/test_fcl_elementary.cpp\n  const MovingPair pair{"
      << "ContinuousContactKind::" << kindName(pair.kind) << ", {{" << std::hexfloat;
  for (const detail::deformable::VertexPath& p : pair.x) {
    out << "{";
    for (const auto* frame : {&p.t0, &p.t1})
      out << "{" << (*frame)[0] << ", " << (*frame)[1] << ", " << (*frame)[2]
          << (frame == &p.t0 ? "}, " : "}");
    out << "}, ";
  }
  out << "}}};\n  const auto result = elementaryTest(pair.kind, pair.points(), 0, 1, "
      << toc_err << ");\n"
      << expected;
  return out.str();
}

}  // namespace test
}  // namespace fcl

#endif

// SPDX-License-Identifier: BSD-3-Clause
//
// The engines without FCL: this program links fcl_ccd_core, and neither FCL nor Eigen.
// Two triangles are one mesh, and the second falls through the first.
#include <cstddef>
#include <cstdio>
#include <stdexcept>

#include "base/error.h"
#include "query/deformable_query.h"

using namespace fcl::detail::deformable;

namespace {

int failures = 0;

void expect(bool is_true, const char* what) {
  std::printf("%s  %s\n", is_true ? "ok    " : "FAILED", what);
  failures += is_true ? 0 : 1;
}

bool throwsInvalidArgument() {
  try {
    throwBadInput("a text");
  } catch (const std::invalid_argument&) {
    return true;
  }
}

}  // namespace

int main() {
  const double t0[] = {0, 0, 0, 4, 0, 0, 0, 4, 0, 1, 1, 1, 2, 1, 2, 1, 2, 2},
               t1[] = {0, 0, 0, 4, 0, 0, 0, 4, 0, 1, 1, -1, 2, 1, 0, 1, 2, 0};
  const std::size_t triangles[][3] = {{0, 1, 2}, {3, 4, 5}};
  constexpr std::size_t kNumVertices = 6;
  const VertexFrames frames(t0, t1, kNumVertices);
  MovingKdopTree tree;
  tree.build(triangles, 2, frames);
  tree.refit(frames);
  MeshInstance mesh;
  mesh.frames = frames;
  mesh.tree = &tree;
  const QueryAnswer answer = querySelf(mesh, QueryOptions());
  expect(!answer.contacts.empty(), "the triangles touch");
  expect(answer.first.lo <= .5 && .5 <= answer.first.hi, "first at 0.5");
  expect(throwsInvalidArgument(), "bad input is an invalid argument");
  return failures;
}

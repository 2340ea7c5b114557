// SPDX-License-Identifier: BSD-3-Clause
//
// One elementary test: a vertex against a triangle, and an edge against an edge. Points
// are given at t = 0 and at t = 1 and move on straight lines. The decision is exact; the
// first time of contact is in [toc_lo, toc_hi].
#include <cstdio>

#include <fcl/narrowphase/continuous_features.h>

namespace {

using fcl::ContinuousFeatureTestResultd;
using fcl::Vector3d;

bool report(const char* what, const ContinuousFeatureTestResultd& found, bool is_contact,
            double toc) {
  std::printf("%-28s %-10s [%.9f, %.9f]\n", what,
              found.is_contact ? "contact" : "no contact", found.toc_lo, found.toc_hi);
  if (found.is_contact != is_contact) return false;
  return !is_contact || (found.toc_lo <= toc && toc <= found.toc_hi &&
                         found.toc_hi - found.toc_lo <= 1e-6);
}

}  // namespace

int main() {
  const double toc_err = 1e-6;  // width of the bracket, in units of the step
  const Vector3d f0(0, 0, 0), f1(1, 0, 0), f2(0, 1, 0);  // a triangle at rest
  bool ok = true;

  // A vertex falls through the triangle.
  ok &= report("falls through the face",
               fcl::vertexFace<double>(Vector3d(.2, .2, 1), f0, f1, f2,
                                       Vector3d(.2, .2, -3), f0, f1, f2, toc_err),
               true, .25);
  // It falls on the border: still a contact, a triangle contains its border.
  ok &= report("falls on the border",
               fcl::vertexFace<double>(Vector3d(.5, .5, 1), f0, f1, f2,
                                       Vector3d(.5, .5, -1), f0, f1, f2, toc_err),
               true, .5);
  // It passes beside the border, by less than 1e-15.
  ok &= report(
      "passes just beside",
      fcl::vertexFace<double>(Vector3d(.5, .5000000000000002, 1), f0, f1, f2,
                              Vector3d(.5, .5000000000000002, -1), f0, f1, f2, toc_err),
      false, 1);
  // It lies on the triangle and leaves: contact at t = 0.
  ok &= report("rests and leaves",
               fcl::vertexFace<double>(Vector3d(.2, .2, 0), f0, f1, f2,
                                       Vector3d(.2, .2, 1), f0, f1, f2, toc_err),
               true, 0);
  // Two edges cross; one of them turns and falls.
  const Vector3d ea0(-1, 0, 0), ea1(1, 0, 0);
  ok &= report(
      "edges meet",
      fcl::edgeEdge<double>(ea0, ea1, Vector3d(0, -1, 1), Vector3d(0, 1, 1), ea0, ea1,
                            Vector3d(.5, -1, -1), Vector3d(-.5, 1, -1), toc_err),
      true, .5);
  return ok ? 0 : 1;
}

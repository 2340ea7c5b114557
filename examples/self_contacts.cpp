// SPDX-License-Identifier: BSD-3-Clause
//
// All contacts of a cloth with itself, and a response. A folded cloth falls on itself.
// Each contact takes away the approach of its features, until the step has no contact.
// What still touches after 20 rounds stays where the step began.
#include <cmath>
#include <cstdio>
#include <vector>

#include <fcl/geometry/bvh/deformable_bvh_model.h>
#include <fcl/narrowphase/continuous_collision.h>

namespace {

using Frame = std::vector<fcl::Vector3d>;
constexpr std::size_t kColumns = 12, kRows = 41;

/// A strip whose rows go forth in its lower half and back in its upper half.
Frame foldedStrip() {
  Frame frame;
  for (std::size_t i = 0; i < kRows * kColumns; ++i) {
    const double angle = std::acos(-1.) * double(i / kColumns) / double(kRows - 1);
    frame.emplace_back(.1 * double(i % kColumns) + .03 * angle, 2 * std::sin(angle),
                       -.1 * std::cos(angle));
  }
  return frame;
}

std::vector<fcl::Triangle> stripTriangles() {
  std::vector<fcl::Triangle> triangles;
  for (std::size_t v = 0; v + kColumns < kRows * kColumns; ++v) {
    if (v % kColumns + 1 == kColumns) continue;
    triangles.emplace_back(v, v + 1, v + kColumns + 1);
    triangles.emplace_back(v, v + kColumns + 1, v + kColumns);
  }
  return triangles;
}

/// Takes the approach along the normal out of the motion, or all motion.
void respond(const fcl::ContinuousContactd& contact, bool hold, const Frame& now,
             Frame& next) {
  const auto id = [&](int k) { return std::size_t(contact.vertices[std::size_t(k)]); };
  const int split = contact.kind == fcl::ContinuousContactKind::kVertexFace ? 1 : 2;
  double approach = 0;  // of the vertices before `split`, towards those behind it
  for (int k = 0; k < 4; ++k) {
    const std::size_t v = id(k);
    if (hold) next[v] = now[v];
    const double weight = k < split ? 1. / split : -1. / (4 - split);
    approach += weight * contact.normal.dot(next[v] - now[v]);
  }
  for (int k = 0; !hold && k < 4; ++k)
    next[id(k)] -= (k < split ? .55 : -.55) * approach * contact.normal;
}

}  // namespace

int main() {
  Frame now = foldedStrip();
  fcl::DeformableBVHModel<> cloth;
  cloth.beginModel();
  cloth.addSubModel(now, stripTriangles());
  cloth.endModel(fcl::FclTree::kSkip);  // FCL's own tree is not needed here
  std::size_t responses = 0;
  for (int step = 0; step < 20; ++step) {
    Frame next = now;
    for (std::size_t v = kRows / 2 * kColumns; v < next.size(); ++v) next[v].z() -= .02;
    fcl::ContinuousContactResultd result;
    for (int round = 0; round == 0 || result.is_collide; ++round) {
      cloth.updateFrames(now[0].data(), next[0].data(), now.size());
      fcl::continuousSelfCollide(&cloth, fcl::ContinuousContactRequestd(), result);
      if (result.initially_crossing) return 1;  // a contact was missed
      for (const auto& contact : result.contacts) respond(contact, round > 20, now, next);
      responses += result.contacts.size();
    }
    now = next;
  }
  std::printf("%zu responses in 20 steps, no crossing\n", responses);
  return responses > 0 ? 0 : 1;
}

// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_DEMO_PICTURES_H
#define FCL_CCD_DEMO_PICTURES_H

#include <string>
#include <vector>

#include "cloth_over_ball.h"
#include "pictures.h"

namespace fcl {
namespace test {

/// @brief What a picture of a frame needs.
struct Snapshot {
  int frame{0};    // counted from 1
  double time{0};  // s
  std::size_t vertex_face{0};
  std::size_t edge_edge{0};
  std::vector<ContinuousContact<double>> contacts;
  std::vector<Vector3<double>> vertices;
};

/// @brief Keeps what advanceFrame() just did.
Snapshot takeSnapshot(const ClothOverBall& scene, const DemoFrame& frame);

/// @brief A picture of the frame: vertex-face contacts red, edge-edge contacts dark blue.
Image drawSnapshot(const ClothOverBall& scene, const Snapshot& snapshot, int width,
                   int height);

/// @brief The pictures in rows of two, each of the given size.
Image drawSheet(const ClothOverBall& scene, const std::vector<Snapshot>& snapshots,
                int width, int height);

/// @brief The bytes of a PLY of the frame with the same colours.
std::string encodeSnapshot(const ClothOverBall& scene, const Snapshot& snapshot);

}  // namespace test
}  // namespace fcl

#endif

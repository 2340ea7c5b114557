// SPDX-License-Identifier: BSD-3-Clause
#include "box_numbers.h"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>

namespace fcl_ccd {
namespace {

using Kind = fcl::ContinuousContactKind;

/// The index of a box among `size` boxes whose numbers begin at `first`.
std::size_t indexOf(long long box, std::size_t first, std::size_t size,
                    const char* what) {
  const auto begin = static_cast<long long>(first),
             end = begin + static_cast<long long>(size);
  if (box < begin || box >= end)
    throw std::runtime_error(std::to_string(box) + " is not the number of " + what +
                             (size == 0 ? ": there is none"
                                        : ": they have " + std::to_string(begin) +
                                              " to " + std::to_string(end - 1)) +
                             ". Numbers count vertices, then edges, then faces");
  return static_cast<std::size_t>(box - begin);
}

}  // namespace

PairKey pairKey(Kind kind, std::array<int, 4> ids) {
  if (kind == Kind::kVertexFace) {
    std::sort(ids.begin() + 1, ids.end());
  } else {
    std::sort(ids.begin(), ids.begin() + 2);
    std::sort(ids.begin() + 2, ids.end());
    if (std::make_pair(ids[2], ids[3]) < std::make_pair(ids[0], ids[1]))
      std::swap_ranges(ids.begin(), ids.begin() + 2, ids.begin() + 2);
  }
  return {static_cast<int>(kind), ids[0], ids[1], ids[2], ids[3]};
}

BoxNumbers::BoxNumbers(std::size_t num_vertices, const Triangles& triangles)
    : num_vertices_(num_vertices), triangles_(triangles) {
  edges_.reserve(3 * triangles.size());
  for (const auto& t : triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax(t[k], t[(k + 1) % 3]);
      if (low != high) edges_.push_back({low, high});
    }
  std::sort(edges_.begin(), edges_.end(), [](const auto& a, const auto& b) {
    return std::make_pair(a[1], a[0]) < std::make_pair(b[1], b[0]);
  });
  edges_.erase(std::unique(edges_.begin(), edges_.end()), edges_.end());
}

int BoxNumbers::vertexOf(long long box) const {
  return static_cast<int>(indexOf(box, 0, num_vertices_, "a vertex"));
}

const std::array<int, 2>& BoxNumbers::edgeOf(long long box) const {
  return edges_[indexOf(box, num_vertices_, edges_.size(), "an edge")];
}

const std::array<int, 3>& BoxNumbers::faceOf(long long box) const {
  const std::size_t first = num_vertices_ + edges_.size();
  return triangles_[indexOf(box, first, triangles_.size(), "a face")];
}

PairKey BoxNumbers::pairOf(Kind kind, const BoxPair& boxes) const {
  if (kind == Kind::kVertexFace) {
    const std::array<int, 3>& face = faceOf(boxes[1]);
    return pairKey(kind, {vertexOf(boxes[0]), face[0], face[1], face[2]});
  }
  const std::array<int, 2>&a = edgeOf(boxes[0]), &b = edgeOf(boxes[1]);
  return pairKey(kind, {a[0], a[1], b[0], b[1]});
}

}  // namespace fcl_ccd

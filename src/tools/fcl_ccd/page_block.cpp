// SPDX-License-Identifier: BSD-3-Clause
#include "page_block.h"

#include <zlib.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <stdexcept>

namespace fcl_ccd {

ViewGrid ViewGrid::of(const Vertices& vertices, int cells) {
  std::array<double, 3> lo, hi;
  lo.fill(std::numeric_limits<double>::infinity());
  hi.fill(-std::numeric_limits<double>::infinity());
  for (const auto& p : vertices)
    for (std::size_t k = 0; k < 3; ++k) {
      lo[k] = std::min(lo[k], p[k]);
      hi[k] = std::max(hi[k], p[k]);
    }
  ViewGrid grid;
  // Halves, so that the largest numbers do not overflow.
  for (std::size_t k = 0; k < 3; ++k) grid.origin[k] = 0.5 * lo[k] + 0.5 * hi[k];
  const double diagonal =
      std::hypot(hi[0] / 2 - lo[0] / 2, hi[1] / 2 - lo[1] / 2, hi[2] / 2 - lo[2] / 2) * 2;
  if (diagonal > 0 && std::isfinite(diagonal))
    grid.spacing = std::max(std::numeric_limits<double>::min(),
                            std::exp2(std::ceil(std::log2(diagonal / cells))));
  return grid;
}

std::int32_t ViewGrid::nodeOf(double x, std::size_t axis) const {
  // Differences of differences of nodes, with their sign, stay below 2^32.
  constexpr double kLast = 1 << 28;
  return static_cast<std::int32_t>(
      std::lround(std::clamp((x - origin[axis]) / spacing, -kLast, kLast)));
}

void appendNumbers(const std::vector<std::int64_t>& numbers, std::string& bytes) {
  for (const std::int64_t number : numbers) {
    assert(std::abs(number) < std::int64_t{1} << 31);
    // 0, -1, 1, -2, ... become 0, 1, 2, 3, ...; seven bits a byte, the lowest first.
    auto rest = (static_cast<std::uint64_t>(number) << 1) ^
                static_cast<std::uint64_t>(number < 0 ? -1 : 0);
    for (; rest > 127; rest >>= 7)
      bytes += static_cast<char>(static_cast<unsigned char>(rest & 127u) | 128u);
    bytes += static_cast<char>(rest);
  }
}

void appendMotion(const ViewGrid& grid, const Vertices* before, const Vertices& after,
                  std::string& bytes) {
  assert(before == nullptr || before->size() == after.size());
  std::vector<std::int64_t> differences;
  differences.reserve(3 * after.size());
  for (std::size_t axis = 0; axis < 3; ++axis) {
    std::int64_t last = 0;
    for (std::size_t v = 0; v < after.size(); ++v) {
      const std::int64_t from =
          before == nullptr ? 0 : grid.nodeOf((*before)[v][axis], axis);
      const std::int64_t moved = grid.nodeOf(after[v][axis], axis) - from;
      differences.push_back(moved - last);
      last = moved;
    }
  }
  appendNumbers(differences, bytes);
}

std::string packed(std::string_view bytes) {
  // Level 6 makes a page an eighth smaller than level 1, in the time of a frame's query.
  constexpr int kLevel = 6;
  uLongf size = compressBound(static_cast<uLong>(bytes.size()));
  std::string compressed(size, '\0');
  if (compress2(reinterpret_cast<Bytef*>(compressed.data()), &size,
                reinterpret_cast<const Bytef*>(bytes.data()),
                static_cast<uLong>(bytes.size()), kLevel) != Z_OK)
    throw std::runtime_error("zlib has no memory for the page of the run");
  compressed.resize(size);
  return base64(compressed);
}

std::string base64(std::string_view bytes) {
  constexpr char kDigits[] =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k)
      group = group << 8 |
              (k < count ? static_cast<unsigned char>(bytes[i + k]) : std::uint32_t{0});
    for (std::size_t k = 0; k < 4; ++k)
      text += k <= count ? kDigits[group >> (18 - 6 * k) & 63u] : '=';
  }
  assert(text.size() == (bytes.size() + 2) / 3 * 4);
  return text;
}

}  // namespace fcl_ccd

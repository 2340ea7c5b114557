// SPDX-License-Identifier: BSD-3-Clause
#include "model/coordinate_arrays.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <vector>

#include "base/default_floating_point.h"
#include "base/parallel.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

/// The number of vertices of a task.
constexpr std::size_t kBlock = 8192;

/// Calls visit(first, last) for blocks of vertices. Returns `none`, then its results
/// block by block.
template <typename T, typename Visit>
std::vector<T> ofBlocks(std::size_t num_vertices, int num_threads, const T& none,
                        Visit&& visit) {
  std::vector<T> results(1 + (num_vertices + kBlock - 1) / kBlock, none);
  parallelForBlocks(num_vertices, kBlock, num_threads,
                    [&](std::size_t first, std::size_t last) {
                      results[1 + first / kBlock] = visit(first, last);
                    });
  return results;
}

/// It has no branch, so that several numbers are tested at the same time.
template <typename S>
bool areFinite(const S* coordinates, std::size_t count) {
  int bad = 0;
  for (std::size_t i = 0; i < count; ++i)
    bad |= !(std::abs(coordinates[i]) <= std::numeric_limits<S>::max());
  return bad == 0;
}

/// Four vertices at the same time.
template <typename S>
struct WideBounds {
  static constexpr std::size_t kWidth = 12;
  S lo[kWidth], hi[kWidth];

  WideBounds() {
    std::fill(lo, lo + kWidth, std::numeric_limits<S>::max());
    std::fill(hi, hi + kWidth, -std::numeric_limits<S>::max());
  }
  void add(const S* coordinates, std::size_t count) {
    std::size_t i = 0;
    for (; i + kWidth <= count; i += kWidth)
      for (std::size_t k = 0; k < kWidth; ++k) add(coordinates[i + k], k);
    for (std::size_t k = 0; i + k < count; ++k) add(coordinates[i + k], k);
  }
  void add(const WideBounds& other) {
    for (std::size_t k = 0; k < kWidth; ++k) {
      lo[k] = std::min(lo[k], other.lo[k]);
      hi[k] = std::max(hi[k], other.hi[k]);
    }
  }

 private:
  void add(S x, std::size_t k) {
    lo[k] = std::min(lo[k], x);
    hi[k] = std::max(hi[k], x);
  }
};

}  // namespace

template <typename S>
std::size_t findNotFinite(const S* coordinates, std::size_t num_vertices,
                          int num_threads) {
  const auto results = ofBlocks(
      num_vertices, num_threads, num_vertices, [&](std::size_t first, std::size_t last) {
        if (areFinite(coordinates + 3 * first, 3 * (last - first))) return num_vertices;
        while (areFinite(coordinates + 3 * first, 3)) ++first;
        assert(first < last);  // one of the block is not finite
        return first;
      });
  return *std::min_element(results.begin(), results.end());
}

template <typename S>
FrameBounds<S> boundFrames(const S* previous, const S* current, std::size_t num_vertices,
                           int num_threads) {
  const DefaultFloatingPoint mode;
  WideBounds<S> all;
  for (const WideBounds<S>&bounds : ofBlocks(num_vertices, num_threads, WideBounds<S>(),
                                             [&](std::size_t first, std::size_t last) {
                                               WideBounds<S> block;
                                               for (const S* frame : {previous, current})
                                                 block.add(frame + 3 * first,
                                                           3 * (last - first));
                                               return block;
                                             }))
    all.add(bounds);
  FrameBounds<S> out;
  for (std::size_t k = 0; k < 3; ++k) {
    out.lo[k] = std::min({all.lo[k], all.lo[k + 3], all.lo[k + 6], all.lo[k + 9]});
    out.hi[k] = std::max({all.hi[k], all.hi[k + 3], all.hi[k + 6], all.hi[k + 9]});
    out.center[k] = (out.lo[k] + out.hi[k]) * S(0.5);
  }
  const auto squared_distances =
      ofBlocks(num_vertices, num_threads, S(0), [&](std::size_t first, std::size_t last) {
        S largest = 0;
        for (const S* frame : {previous, current})
          for (const S* p = frame + 3 * first; p != frame + 3 * last; p += 3) {
            const S x = out.center[0] - p[0], y = out.center[1] - p[1],
                    z = out.center[2] - p[2];
            largest = std::max(largest, x * x + y * y + z * z);
          }
        return largest;
      });
  out.radius =
      std::sqrt(*std::max_element(squared_distances.begin(), squared_distances.end()));
  return out;
}

#define FCL_CCD_INSTANTIATE(S)                                    \
  template std::size_t findNotFinite(const S*, std::size_t, int); \
  template FrameBounds<S> boundFrames(const S*, const S*, std::size_t, int);
FCL_CCD_INSTANTIATE(double)
FCL_CCD_INSTANTIATE(float)
#undef FCL_CCD_INSTANTIATE

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

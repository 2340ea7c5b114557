// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_TREE_SEPARATING_AXES_H
#define FCL_CCD_TREE_SEPARATING_AXES_H

#include <cassert>
#include <cstdint>
#include <cstring>

#include "tree/mesh_instance.h"

namespace fcl {
namespace detail {
namespace deformable {

/// @brief Proves boxes of two translating rigid meshes apart whose 16-DOPs overlap. A
/// 16-DOP around an OBB is much wider than the OBB. So without this test two to three
/// times as many boxes overlap.
class SeparatingAxes {
 public:
  /// @param a, b  meshes without moving trees; they must outlive this
  /// @param distance  triangles that come within it are wanted; 0: those that touch
  SeparatingAxes(const MeshInstance& a, const MeshInstance& b, double distance = 0);

  /// @brief Whether areApart() is worth its time for two boxes with this sum of extents.
  /// It is not for AABBs. Of boxes that move far relative to their size few are proved
  /// apart as a rule: AxisTrials tells where it is worth its time.
  bool mayHelp(float extents) const { return least_extents_ <= extents; }

  /// @brief Whether a tree has oriented boxes. If not, areApart() is of no use.
  bool areOriented() const { return are_oriented_; }

  /// @brief Proves that the triangles below node i of a's tree and below node j of b's
  /// stay further apart than the distance during the whole step. The proof is an axis of
  /// one of the two boxes along which one box is always on the same side of the other
  /// (Gottschalk, Lin, Manocha 1996). The nine cross products of axes are not tested,
  /// since they would prove few more. NaN: not proved.
  bool areApart(int i, int j) const;

 private:
  double padOf(double sizes) const;

  const RigidTree& a_;
  const RigidTree& b_;
  /// Translation of b relative to a in both frames, and a bound on the coordinates of all
  /// translations.
  double translation_[2][3];
  double size_{0};
  double distance_;
  bool are_oriented_;
  float least_extents_;
};

/// @brief Learns where SeparatingAxes::areApart() is worth its time, for boxes that move
/// far relative to their size. As a rule few of these are proved apart. But where close
/// surfaces slide along each other, their 16-DOPs overlap at some time with hundreds of
/// others, and nearly all of these are proved apart. Boxes of one size (a power of two)
/// lie alike, so each size has a record of its own. For one task: another one begins
/// anew, so that no answer depends on how tasks are given to threads.
class AxisTrials {
 public:
  /// @brief Forgets all records.
  void begin() {
    std::memset(record_, 0, sizeof(record_));
    num_asked_ = 0;
  }

  /// @brief Whether two boxes should be tested.
  /// @param extents  the sum of those of both boxes
  bool isDue(float extents) {
    if (num_asked_ < kFirst) {
      ++num_asked_;
      return false;
    }
    Record& record = of(extents);
    if (record.wait == 0) return true;
    --record.wait;
    return false;
  }

  /// @brief Notes what the test has shown.
  void note(float extents, bool is_apart) {
    Record& record = of(extents);
    if (is_apart) {
      record.pause = 0;
      record.credit = static_cast<std::uint8_t>(
          record.credit < kMostCredit ? record.credit + 2 : record.credit);
    } else if (record.credit > 0) {
      --record.credit;
    } else {
      record.pause =
          static_cast<std::uint16_t>(record.pause == 0              ? kFirstPause
                                     : record.pause < kLongestPause ? 2 * record.pause
                                                                    : record.pause);
      record.wait = record.pause;
    }
    assert(record.credit <= kMostCredit + 1 && record.pause <= kLongestPause);
  }

 private:
  /// A test pays where one of three succeeds: it takes a sixth of the time that it may
  /// save. So a success is worth two failures. After more failures the next test waits,
  /// ever longer: at last 1 of 257 pairs is tested, which is a thousandth of the time. A
  /// task with few pairs tests none.
  static constexpr int kMostCredit = 14;
  static constexpr std::uint16_t kFirstPause = 8, kLongestPause = 256;
  static constexpr std::uint32_t kFirst = 32;

  struct Record {
    std::uint16_t wait, pause;
    std::uint8_t credit;
  };
  static constexpr std::size_t kSizes = 32;

  /// By the last bits of the exponent.
  Record& of(float extents) {
    std::uint32_t bits;
    std::memcpy(&bits, &extents, sizeof(bits));
    return record_[(bits >> 23) % kSizes];
  }

  Record record_[kSizes]{};
  std::uint32_t num_asked_{0};
};

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

#endif

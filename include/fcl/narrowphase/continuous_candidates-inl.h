// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_NARROWPHASE_CONTINUOUS_CANDIDATES_INL_H
#define FCL_NARROWPHASE_CONTINUOUS_CANDIDATES_INL_H

#include "fcl/narrowphase/continuous_candidates.h"
#include "fcl/narrowphase/detail/pose_numbers.h"
#include "fcl/narrowphase/detail/query_numbers.h"

namespace fcl {

inline bool continuousSelfCandidates(const CollisionGeometry<double>* o,
                                     const ContinuousCandidateSink& sink) {
  return detail::answerSelfCandidates(o, sink);
}

inline bool continuousSelfCandidates(const CollisionGeometry<float>* o,
                                     const ContinuousCandidateSink& sink) {
  return detail::answerSelfCandidates(o, sink);
}

inline bool continuousCandidates(const CollisionGeometry<double>* o1,
                                 const Transform3<double>& tf1_beg,
                                 const Transform3<double>& tf1_end,
                                 const CollisionGeometry<double>* o2,
                                 const Transform3<double>& tf2_beg,
                                 const Transform3<double>& tf2_end,
                                 const ContinuousCandidateSink& sink) {
  return detail::answerCandidates(detail::movingGeometry(o1, tf1_beg, tf1_end),
                                  detail::movingGeometry(o2, tf2_beg, tf2_end), sink);
}

inline bool continuousCandidates(const CollisionGeometry<float>* o1,
                                 const Transform3<float>& tf1_beg,
                                 const Transform3<float>& tf1_end,
                                 const CollisionGeometry<float>* o2,
                                 const Transform3<float>& tf2_beg,
                                 const Transform3<float>& tf2_end,
                                 const ContinuousCandidateSink& sink) {
  return detail::answerCandidates(detail::movingGeometry(o1, tf1_beg, tf1_end),
                                  detail::movingGeometry(o2, tf2_beg, tf2_end), sink);
}

}  // namespace fcl

#endif

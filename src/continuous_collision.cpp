// SPDX-License-Identifier: BSD-3-Clause
#include "fcl/narrowphase/continuous_collision.h"

#include <algorithm>
#include <chrono>
#include <limits>
#include <optional>
#include <string>
#include <type_traits>
#include <typeinfo>

#include "fcl/common/exception.h"
#include "fcl/math/bv/utility.h"
#include "fcl/narrowphase/detail/deformable/contact_conversion.h"
#include "fcl/narrowphase/detail/deformable/default_floating_point.h"
#include "fcl/narrowphase/detail/deformable/deformable_query.h"
#include "fcl/narrowphase/detail/deformable/prepared_mesh.h"
#include "parallel.h"
#include "query_arguments.h"
#include "stock_fcl.h"

namespace fcl {
namespace {

using detail::answerOf;
using detail::areMeshes;
using detail::isAnsweredHere;
using detail::kNotAnsweredHere;
using detail::Placement;
using detail::require;
using detail::requireFinite;
using detail::requireMesh;
using detail::deformable::inArena;
using detail::deformable::PreparedMesh;
using detail::deformable::QueryAnswer;
using detail::deformable::QueryGoal;
using detail::deformable::QueryOptions;

template <typename S>
QueryOptions makeOptions(const ContinuousCollisionRequest<S>& request) {
  QueryOptions options;
  options.goal = QueryGoal::kFirst;
  options.max_contacts = 1;
  options.toc_err = static_cast<double>(request.toc_err);
  options.stop_at_crossing = true;
  if (!(options.toc_err > 0)) throw Exception("request.toc_err is not positive");
  return options;
}

template <typename S>
QueryOptions makeOptions(const ContinuousContactRequest<S>& request) {
  QueryOptions options =
      makeOptions(static_cast<const ContinuousCollisionRequest<S>&>(request));
  if (request.num_max_contacts == 0) throw Exception("request.num_max_contacts is 0");
  options.goal = request.query == ContinuousQuery::kAll     ? QueryGoal::kAll
                 : request.query == ContinuousQuery::kFirst ? QueryGoal::kFirst
                                                            : QueryGoal::kAny;
  options.max_contacts = request.num_max_contacts;
  options.stop_at_crossing = false;
  if (request.num_threads < 0) throw Exception("request.num_threads is negative");
  options.num_threads = request.num_threads;
  return options;
}

/// Translation on a straight line, rotation at constant speed (a deforming mesh only:
/// its vertices do not follow it).
template <typename S>
Transform3<S> poseAt(const Placement<S>& placement, S t) {
  Transform3<S> tf = placement.beginning;
  tf.translation() =
      (1 - t) * placement.beginning.translation() + t * placement.end.translation();
  if (placement.isRotating())
    tf.linear() = Quaternion<S>(placement.beginning.linear())
                      .slerp(t, Quaternion<S>(placement.end.linear()))
                      .toRotationMatrix();
  return tf;
}

/// The part of the result that FCL's own type has.
template <typename S>
void fill(const QueryAnswer& answer, const Placement<S>& placement1,
          const Placement<S>& placement2, ContinuousCollisionResult<S>& result) {
  result.is_collide = answer.has_crossing || !answer.contacts.empty();
  result.time_of_contact =
      answer.has_crossing ? S(0)
      : answer.contacts.empty()
          ? S(1)
          : detail::deformable::roundTimeDown<S>(answer.contacts.front().toc_lo);
  result.contact_tf1 = poseAt(placement1, result.time_of_contact);
  result.contact_tf2 = poseAt(placement2, result.time_of_contact);
}

/// What a query looked at, for the conversion of its contacts.
template <typename S>
struct Scene {
  const CollisionGeometry<S>& o1;
  const CollisionGeometry<S>& o2;
  const PreparedMesh& mesh1;
  const PreparedMesh& mesh2;
};

template <typename S>
void fillContacts(const QueryAnswer&, const Scene<S>&,
                  const ContinuousCollisionRequest<S>&, ContinuousCollisionResult<S>&) {}

template <typename S>
void fillContacts(const QueryAnswer& answer, const Scene<S>& scene,
                  const ContinuousContactRequest<S>& request,
                  ContinuousContactResult<S>& result) {
  const auto start = std::chrono::steady_clock::now();
  const auto convert = [&](const auto& contact) {
    auto out = detail::deformable::toContinuousContact<S>(
        contact, scene.mesh1.instance(), scene.mesh2.instance(), request.enable_contact);
    out.o1 = &scene.o1;
    out.o2 = &scene.o2;
    return out;
  };
  const std::size_t count = answer.contacts.size();
  const auto contactAt = [&](std::size_t i) {
    // Contacts that follow each other in time lie anywhere in memory.
    constexpr std::size_t kAhead = 16;
    __builtin_prefetch(&answer.contacts[std::min(i + kAhead, count - 1)]);
    return convert(answer.contacts[i]);
  };
  // Memory before anything changes.
  result.contacts.reserve(count);
  if (detail::deformable::numThreads(request.num_threads) == 1) {
    result.contacts.clear();
    for (std::size_t i = 0; i < count; ++i) result.contacts.push_back(contactAt(i));
  } else {
    // Written twice.
    constexpr std::size_t kBlock = 1024;
    result.contacts.resize(count);
    detail::deformable::parallelForBlocks(count, kBlock, request.num_threads,
                                          [&](std::size_t i, std::size_t last) {
                                            for (; i < last; ++i)
                                              result.contacts[i] = contactAt(i);
                                          });
  }
  result.contacts_cut = answer.cut;
  result.initially_crossing = answer.has_crossing;
  result.crossing =
      answer.has_crossing ? convert(answer.crossing) : ContinuousContact<S>();
  result.counts = answer.counts;
  result.times = answer.times;
  result.times.update += scene.mesh1.updateTime();
  if (&scene.mesh1 != &scene.mesh2) result.times.update += scene.mesh2.updateTime();
  result.times.test +=
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

template <typename S, typename Request, typename Result>
S collideMeshes(const CollisionGeometry<S>& o1, const Placement<S>& placement1,
                const CollisionGeometry<S>& o2, const Placement<S>& placement2,
                const Request& request, Result& result) {
  const QueryOptions options = makeOptions(request);
  inArena(options.num_threads, [&] {
    const detail::deformable::DefaultFloatingPoint mode;
    const PreparedMesh mesh1(o1, placement1.beginning, placement1.end, "o1",
                             options.num_threads);
    const PreparedMesh mesh2(o2, placement2.beginning, placement2.end, "o2",
                             options.num_threads);
    const QueryAnswer answer =
        answerOf([&] { return queryPair(mesh1.instance(), mesh2.instance(), options); });
    fillContacts(answer, Scene<S>{o1, o2, mesh1, mesh2}, request, result);
    fill(answer, placement1, placement2, result);
  });
  return result.time_of_contact;
}

template <typename S, typename Request, typename Result>
S selfCollide(const CollisionGeometry<S>* o, const Request& request, Result& result) {
  require(o, "o");
  const QueryOptions options = makeOptions(request);
  requireMesh(*o, "continuousSelfCollide");
  const Placement<S> still{Transform3<S>::Identity(), Transform3<S>::Identity()};
  inArena(options.num_threads, [&] {
    const detail::deformable::DefaultFloatingPoint mode;
    const PreparedMesh mesh(*o, still.beginning, still.end, "o", options.num_threads);
    const QueryAnswer answer =
        answerOf([&] { return querySelf(mesh.instance(), options); });
    fillContacts(answer, Scene<S>{*o, *o, mesh, mesh}, request, result);
    fill(answer, still, still, result);
  });
  return result.time_of_contact;
}

template <typename Motion, typename S>
bool readMotion(const MotionBase<S>& motion, Placement<S>& placement) {
  // FCL's InterpMotion<float> and ScrewMotion<float> are abstract: there are none to
  // read.
  if constexpr (!std::is_abstract_v<Motion>) {
    // Of this class and of none derived from it, which may move otherwise.
    if (typeid(motion) != typeid(Motion)) return false;
    // integrate() changes the motion.
    const Motion copy(static_cast<const Motion&>(motion));
    copy.integrate(0);
    copy.getCurrentTransform(placement.beginning);
    copy.integrate(1);
    copy.getCurrentTransform(placement.end);
    if (detail::isConstantRotation(placement))
      placement.end.linear() = placement.beginning.linear();
    return true;
  }
  return false;
}

/// The ends of a motion of FCL's, which stays as it is.
template <typename S>
std::optional<Placement<S>> placementOf(const MotionBase<S>& motion) {
  Placement<S> placement{Transform3<S>::Identity(), Transform3<S>::Identity()};
  if (readMotion<TranslationMotion<S>>(motion, placement) ||
      readMotion<InterpMotion<S>>(motion, placement) ||
      readMotion<ScrewMotion<S>>(motion, placement) ||
      readMotion<SplineMotion<S>>(motion, placement))
    return placement;
  return std::nullopt;
}

/// The ends of a motion of the caller's own, which nobody can copy: it is at its
/// beginning afterwards.
template <typename S>
Placement<S> integratedEnds(const MotionBase<S>& motion) {
  Placement<S> placement;
  motion.integrate(1);
  motion.getCurrentTransform(placement.end);
  motion.integrate(0);
  motion.getCurrentTransform(placement.beginning);
  return placement;
}

/// A motion that is not known to follow a straight line counts as a rotation: a rigid
/// mesh that follows it is FCL's.
template <typename S>
bool isRotation(const MotionBase<S>& motion, const std::optional<Placement<S>>& ends) {
  return !ends || ends->isRotating() || typeid(motion) == typeid(SplineMotion<S>);
}

/// FCL's own function, for what is not answered here.
template <typename S>
S collideInFcl(const CollisionGeometry<S>* o1, const MotionBase<S>* motion1,
               const CollisionGeometry<S>* o2, const MotionBase<S>* motion2,
               const ContinuousCollisionRequest<S>& request,
               ContinuousCollisionResult<S>& result) {
  return detail::stockContinuousCollide(o1, motion1, o2, motion2, request, result);
}

template <typename S>
S collideInFcl(const CollisionGeometry<S>*, const MotionBase<S>*,
               const CollisionGeometry<S>*, const MotionBase<S>*,
               const ContinuousContactRequest<S>&, ContinuousContactResult<S>&) {
  throw Exception(std::string("contacts") + kNotAnsweredHere);
}

template <typename S, typename Request, typename Result>
S collideMotions(const CollisionGeometry<S>* o1, const MotionBase<S>* motion1,
                 const CollisionGeometry<S>* o2, const MotionBase<S>* motion2,
                 const Request& request, Result& result) {
  require(o1, "o1");
  require(o2, "o2");
  require(motion1, "motion1");
  require(motion2, "motion2");
  if (areMeshes(*o1, *o2)) {
    const std::optional<Placement<S>> ends1 = placementOf(*motion1),
                                      ends2 = placementOf(*motion2);
    if (isAnsweredHere(*o1, isRotation(*motion1, ends1), *o2,
                       isRotation(*motion2, ends2)))
      return collideMeshes(*o1, ends1 ? *ends1 : integratedEnds(*motion1), *o2,
                           ends2 ? *ends2 : integratedEnds(*motion2), request, result);
    if (ends1) requireFinite(*ends1, "o1");
    if (ends2) requireFinite(*ends2, "o2");
  }
  return collideInFcl(o1, motion1, o2, motion2, request, result);
}

template <typename S, typename Request, typename Result>
S collideTransforms(const CollisionGeometry<S>* o1, const Placement<S>& placement1,
                    const CollisionGeometry<S>* o2, const Placement<S>& placement2,
                    const Request& request, Result& result) {
  require(o1, "o1");
  require(o2, "o2");
  const Placement<S> placed1 = detail::withoutRounding(*o1, placement1),
                     placed2 = detail::withoutRounding(*o2, placement2);
  if (isAnsweredHere(*o1, placed1.isRotating(), *o2, placed2.isRotating()))
    return collideMeshes(*o1, placed1, *o2, placed2, request, result);
  requireFinite(*o1, placement1, *o2, placement2);
  const auto motionOf = [&request](const Placement<S>& placement) {
    return detail::stockMotion(placement.beginning, placement.end,
                               request.ccd_motion_type);
  };
  return collideInFcl<S>(o1, motionOf(placement1).get(), o2, motionOf(placement2).get(),
                         request, result);
}

template <typename S, typename Request, typename Result>
S collideObjects(const CollisionObject<S>* o1, const Transform3<S>& tf1_end,
                 const CollisionObject<S>* o2, const Transform3<S>& tf2_end,
                 const Request& request, Result& result) {
  require(o1, "o1");
  require(o2, "o2");
  return collideTransforms<S>(
      o1->collisionGeometry().get(), {o1->getTransform(), tf1_end},
      o2->collisionGeometry().get(), {o2->getTransform(), tf2_end}, request, result);
}

template <typename S, typename Request, typename Result>
S collideMovingObjects(const ContinuousCollisionObject<S>* o1,
                       const ContinuousCollisionObject<S>* o2, const Request& request,
                       Result& result) {
  require(o1, "o1");
  require(o2, "o2");
  return collideMotions<S>(o1->collisionGeometry().get(), o1->getMotion(),
                           o2->collisionGeometry().get(), o2->getMotion(), request,
                           result);
}

}  // namespace

#define FCL_CCD_DEFINE_QUERIES(S, Request, Result)                                       \
  S continuousCollide(const CollisionGeometry<S>* o1, const MotionBase<S>* motion1,      \
                      const CollisionGeometry<S>* o2, const MotionBase<S>* motion2,      \
                      const Request<S>& request, Result<S>& result) {                    \
    return collideMotions(o1, motion1, o2, motion2, request, result);                    \
  }                                                                                      \
  S continuousCollide(const CollisionGeometry<S>* o1, const Transform3<S>& tf1_beg,      \
                      const Transform3<S>& tf1_end, const CollisionGeometry<S>* o2,      \
                      const Transform3<S>& tf2_beg, const Transform3<S>& tf2_end,        \
                      const Request<S>& request, Result<S>& result) {                    \
    return collideTransforms<S>(o1, {tf1_beg, tf1_end}, o2, {tf2_beg, tf2_end}, request, \
                                result);                                                 \
  }                                                                                      \
  S continuousCollide(const CollisionObject<S>* o1, const Transform3<S>& tf1_end,        \
                      const CollisionObject<S>* o2, const Transform3<S>& tf2_end,        \
                      const Request<S>& request, Result<S>& result) {                    \
    return collideObjects(o1, tf1_end, o2, tf2_end, request, result);                    \
  }                                                                                      \
  S collide(const ContinuousCollisionObject<S>* o1,                                      \
            const ContinuousCollisionObject<S>* o2, const Request<S>& request,           \
            Result<S>& result) {                                                         \
    return collideMovingObjects(o1, o2, request, result);                                \
  }                                                                                      \
  S continuousSelfCollide(const CollisionGeometry<S>* o, const Request<S>& request,      \
                          Result<S>& result) {                                           \
    return selfCollide(o, request, result);                                              \
  }
FCL_CCD_DEFINE_QUERIES(double, ContinuousCollisionRequest, ContinuousCollisionResult)
FCL_CCD_DEFINE_QUERIES(float, ContinuousCollisionRequest, ContinuousCollisionResult)
FCL_CCD_DEFINE_QUERIES(double, ContinuousContactRequest, ContinuousContactResult)
FCL_CCD_DEFINE_QUERIES(float, ContinuousContactRequest, ContinuousContactResult)
#undef FCL_CCD_DEFINE_QUERIES

}  // namespace fcl

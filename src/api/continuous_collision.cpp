// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cassert>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "api/compound_query.h"
#include "api/contact_conversion.h"
#include "base/default_floating_point.h"
#include "base/parallel.h"
#include "base/stopwatch.h"
#include "curved/curved_contacts.h"
#include "curved/shape_contacts.h"
#include "fcl/common/exception.h"
#include "fcl/geometry/bvh/deformable_bvh_model.h"
#include "fcl/narrowphase/detail/query_numbers.h"
#include "mesh/triangle_soup.h"
#include "prepare/checked_request.h"
#include "prepare/class_cast.h"
#include "prepare/posed_flat.h"
#include "prepare/prepared_mesh.h"
#include "prepare/prepared_motion.h"
#include "prepare/prepared_shapes.h"
#include "prepare/query_arguments.h"
#include "prepare/query_range.h"
#include "query/deformable_query.h"

namespace fcl {
namespace detail {
namespace {

using deformable::ContactDescriber;
using deformable::DefaultFloatingPoint;
using deformable::inArena;
using deformable::PreparedMesh;
using deformable::PreparedMotion;
using deformable::QueryAnswer;
using deformable::QueryOptions;

bool isTriangleSoup(const deformable::MeshInstance& mesh, std::size_t num_triangles) {
  const std::size_t num_vertices = mesh.frames.size();
  return mesh.tree
             ? deformable::isTriangleSoup(mesh.tree->triangles(), num_vertices,
                                          mesh.tree->freeLeaves().count())
             : deformable::isTriangleSoup(mesh.triangles, num_triangles, num_vertices);
}

/// Runs a query, unless its filter rejects all pairs.
template <typename Query>
QueryAnswer filteredAnswerOf(const RequestFilter& filter, Query&& query) {
  return filter.rejectsAll() ? QueryAnswer() : answerOf(query);
}

/// @param objects  what has no such test, and what to give in its place
void requireAllSpeeds(const QueryOptions& options, const std::string& objects) {
  if (options.min_approach_speed > 0)
    throw Exception("request.min_approach_speed acts on meshes on straight paths only. " +
                    objects + ", or 0 for contacts at any speed");
}

/// Where the answer of a query goes.
template <typename S>
struct Reply {
  QueryOutcome<S>& outcome;
  /// Null: they are not wanted.
  ContinuousContacts<S>* contacts;

  /// @param queried  the meshes, for ContactDescriber; none with a shape or an octree
  template <typename... Queried>
  void give(const QueryAnswer& answer, const CollisionGeometry<S>& o1,
            const CollisionGeometry<S>& o2, const QueryOptions& options,
            const Queried&... queried) const {
    if (contacts) {
      const ContactDescriber describe(queried..., options);
      deformable::fillContacts(answer, describe, o1, o2, options, *contacts);
    }
    outcome = deformable::outcomeOf<S>(answer);
  }
};

/// Answers two meshes on straight paths.
template <typename S>
void answerStraight(const PlacedGeometry<S>& o1, const PlacedGeometry<S>& o2,
                    const CheckedRequest& request, const Reply<S>& reply) {
  QueryOptions options = request.options;
  const PreparedMesh mesh1(o1.geometry(), o1.beginning(), o1.end(), "o1",
                           options.num_threads),
      mesh2(o2.geometry(), o2.beginning(), o2.end(), "o2", options.num_threads);
  RequestFilter filter(request, o1.geometry(), o2.geometry(), false);
  options.filter = filter.prepare(mesh1.instance(), mesh2.instance());
  QueryAnswer answer = filteredAnswerOf(
      filter, [&] { return queryPair(mesh1.instance(), mesh2.instance(), options); });
  answer.times.update += mesh1.updateTime() + mesh2.updateTime();
  reply.give(answer, o1.geometry(), o2.geometry(), options, mesh1.instance(),
             mesh2.instance());
}

/// Answers two meshes, one of which turns.
template <typename S>
void answerCurved(const PlacedGeometry<S>& o1, const PlacedGeometry<S>& o2,
                  const CheckedRequest& request, const Reply<S>& reply) {
  QueryOptions options = request.options;
  requireAllSpeeds(options, "One of these two turns: give transforms of equal rotation");
  const PreparedMotion motion1(o1, "o1", options.toc_err, options.num_threads),
      motion2(o2, "o2", options.toc_err, options.num_threads);
  RequestFilter filter(request, o1.geometry(), o2.geometry(), false);
  requireProvenRange(motion1, motion2);
  requireLeastSize(motion1, motion2);
  options.filter = filter.prepare();
  QueryAnswer answer = filteredAnswerOf(filter, [&] {
    return queryCurvedContacts(motion1.body(), motion2.body(), options);
  });
  answer.times.update += motion1.updateTime() + motion2.updateTime();
  reply.give(answer, o1.geometry(), o2.geometry(), options, motion1, motion2);
}

/// As in FCL, the cells of an octree meet only what the program calls occupied
/// (cost_density and threshold_occupied).
template <typename S>
bool isNoObstacleFor(const PlacedGeometry<S>& octree, const PlacedGeometry<S>& other) {
  return octree.isOctree() && !other.isOctree() && !other.geometry().isOccupied();
}

template <typename S>
QueryAnswer scaledAnswerOf(const PlacedGeometry<S>& o1, const PlacedGeometry<S>& o2,
                           QueryOptions options, double factor,
                           const PreparedShapes& shapes);

/// @param shapes  what the objects were converted to
template <typename S>
QueryAnswer boundedAnswerOf(const PlacedGeometry<S>& o1, const PlacedGeometry<S>& o2,
                            const QueryOptions& options, const PreparedShapes& shapes,
                            double scale = 1) {
  const int first = firstOf(o1), second = 1 - first;
  const PlacedGeometry<S>* const object[2] = {&o1, &o2};
  assert(!deformable::isUnbounded(object[first]->geometry()));
  const PreparedMotion bounded(*object[first], nameOf(first), options.toc_err,
                               options.num_threads, 0, scale, shapes.shape[first]),
      other(*object[second], nameOf(second), options.toc_err, options.num_threads,
            bounded.isEmpty() ? 0 : bounded.body().size(), scale, shapes.shape[second]);
  if (bounded.isEmpty() || other.isEmpty()) return {};
  const PreparedMotion &motion1 = first == 0 ? bounded : other,
                       &motion2 = first == 0 ? other : bounded;
  if (scale == 1) {
    const double factor =
        scaleOf(o1.moving(), motion1, o2.moving(), motion2, options.min_distance);
    if (factor != 1) {
      deformable::ConvexShape x = *motion1.body().shape(), y = *motion2.body().shape();
      return scaledAnswerOf(o1, o2, options, factor, {{&x, &y}});
    }
  }
  QueryAnswer answer = answerOf(
      [&] { return queryShapeContacts(motion1.body(), motion2.body(), options); });
  answer.times.update = motion1.updateTime() + motion2.updateTime();
  return answer;
}

/// Two shapes whose lengths are multiplied by a power of two: this changes no digit.
template <typename S>
QueryAnswer scaledAnswerOf(const PlacedGeometry<S>& o1, const PlacedGeometry<S>& o2,
                           QueryOptions options, double factor,
                           const PreparedShapes& shapes) {
  const MovingGeometry<S> moving1 = scaledPath(o1.moving(), factor),
                          moving2 = scaledPath(o2.moving(), factor);
  assert(std::ldexp(1, std::ilogb(factor)) == factor);
  options.min_distance *= factor;
  QueryAnswer answer = boundedAnswerOf(
      PlacedGeometry<S>(moving1), PlacedGeometry<S>(moving2), options, shapes, factor);
  for (auto& contact : answer.shape_contacts) {
    contact.position = (1 / factor) * contact.position;
    contact.depth /= factor;
  }
  return answer;
}

/// Follows a shape or an octree, and another one of these or a mesh.
/// @param shapes  what the objects were converted to
template <typename S>
void followShapes(const PlacedGeometry<S>& o1, const PlacedGeometry<S>& o2,
                  const CheckedRequest& request, bool are_flats,
                  const PreparedShapes& shapes, const Reply<S>& reply) {
  const deformable::Stopwatch start;
  QueryOptions options = request.options;
  // The first contact that is found is the first of all.
  if (options.only_time) options.query = ContinuousQuery::kAny;
  RequestFilter filter(request, o1.geometry(), o2.geometry(), false);
  options.filter = filter.prepare();
  QueryAnswer answer;
  if (filter.rejectsAll() || isNoObstacleFor(o1, o2) || isNoObstacleFor(o2, o1)) {
    // No pair counts.
  } else if (are_flats) {
    const deformable::PosedFlat flat1 = deformable::posedFlatOf(o1, "o1"),
                                flat2 = deformable::posedFlatOf(o2, "o2");
    answer = queryFlats(flat1, flat2, options);
  } else {
    answer = boundedAnswerOf(o1, o2, options, shapes);
  }
  answer.times.test = start.seconds() - answer.times.update;
  reply.give(answer, o1.geometry(), o2.geometry(), options);
}

/// Answers a shape or an octree, and another one of these or a mesh.
template <typename S>
void answerShapes(const PlacedGeometry<S>& o1, const PlacedGeometry<S>& o2,
                  const CheckedRequest& request, const Reply<S>& reply) {
  requireAllSpeeds(request.options,
                   "One of these two is a shape or an octree: give a mesh in its place");
  const bool are_flats =
      deformable::isUnbounded(o1.geometry()) && deformable::isUnbounded(o2.geometry());
  const auto follow = [&](const PreparedShapes& shapes) {
    followShapes(o1, o2, request, are_flats, shapes, reply);
  };
  if (are_flats || !request.options.only_time) {
    follow({});
  } else if (areFoundToOverlap(o1, o2, follow)) {
    assert(!reply.contacts);
    reply.outcome = {true, 0, 0, 0};
  }
}

/// Answers two geometries, neither of them a compound.
template <typename S>
void answerGeometries(const PlacedGeometry<S>& o1, const PlacedGeometry<S>& o2,
                      Answerer answerer, const CheckedRequest& request,
                      const Reply<S>& reply) {
  if (answerer == Answerer::kShapes)
    answerShapes(o1, o2, request, reply);
  else if (answerer == Answerer::kCurvedPaths)
    answerCurved(o1, o2, request, reply);
  else
    answerStraight(o1, o2, request, reply);
}

/// The pairs of parts in contact that a query asks for.
///
/// ContinuousQuery::kFirst: a contact may be the first one if its bracket begins no later
/// than the earliest bracket ends. It begins up to toc_err early, so pairs are tested up
/// to toc_err after that end, and the brackets of such contacts are all complete. Pairs
/// whose windows begin together are tested up to the same time. So the answer does not
/// depend on the numbers of the parts.
/// @param pairs  sorted by t_lo
/// @param test  bool test(pair, latest, answer): whether a pair is in contact
template <typename S, typename Test>
std::vector<PartAnswer<S>> answersOf(const std::vector<PartPair>& pairs,
                                     const QueryOptions& options, const Test& test) {
  constexpr double kRounding = 64 * std::numeric_limits<S>::epsilon();
  std::vector<PartAnswer<S>> answers;
  double latest = options.t_max, next_latest = latest;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    assert(i == 0 || pairs[i - 1].t_lo <= pairs[i].t_lo);
    if (i > 0 && pairs[i].t_lo > pairs[i - 1].t_lo) latest = next_latest;
    assert(0 <= latest && latest <= options.t_max);
    if (pairs[i].t_lo > latest) break;
    PartAnswer<S> tested;
    if (!test(pairs[i], latest, tested)) continue;
    if (options.query == ContinuousQuery::kFirst)
      next_latest = std::min(next_latest, double{tested.result.outcome.toc_hi} +
                                              options.toc_err + kRounding);
    answers.push_back(std::move(tested));
    if (options.query == ContinuousQuery::kAny) break;
  }
  return answers;
}

/// Answers two objects, one or both of them compounds.
template <typename S>
void answerCompounds(const PlacedGeometry<S>& o1, const PlacedGeometry<S>& o2,
                     const CheckedRequest& request, const Reply<S>& reply) {
  const deformable::Stopwatch start;
  requireAllSpeeds(request.options,
                   "One of these two is a compound: give a mesh in its place");
  const CompoundPair<S> compounds(o1, o2);
  compounds.requireNoTriangleGroups(request);
  // Far parts are not asked, so that a filter of a wrong size is refused here.
  const RequestFilter filter(request, o1.geometry(), o2.geometry(), false);
  CheckedRequest asked = request;
  StageCounts counts;
  StageTimes times;
  const auto test = [&](const PartPair& pair, double latest, PartAnswer<S>& answer) {
    asked.options.t_max = latest;
    answer.part1 = compounds.number1(pair);
    answer.part2 = compounds.number2(pair);
    auto& result = answer.result;
    compounds.ask(pair, [&](const PlacedGeometry<S>& x, const PlacedGeometry<S>& y) {
      answerGeometries(x, y, answererOf(x, y), asked,
                       {result.outcome, reply.contacts ? &result : nullptr});
    });
    counts += result.counts;
    times.update += result.times.update;
    times.traverse += result.times.traverse;
    return result.outcome.is_collide;
  };
  const QueryOptions& options = request.options;
  std::vector<PartAnswer<S>> answers;
  if (!filter.rejectsAll())
    answers = answersOf<S>(compounds.near(options), options, test);
  const QueryOutcome<S> outcome = earliestOf(answers);
  if (reply.contacts) {
    ContinuousContacts<S> contacts = joinedContacts(std::move(answers), options);
    contacts.counts = counts;
    contacts.times = times;
    contacts.times.test = start.seconds() - times.update - times.traverse;
    *reply.contacts = std::move(contacts);
  }
  reply.outcome = outcome;
}

}  // namespace

template <typename S>
void requireValid(const ContinuousContactRequest<S>& request) {
  static_cast<void>(CheckedRequest(request));
}

template <typename S, typename Request>
bool answerPair(const MovingGeometry<S>& o1, const MovingGeometry<S>& o2,
                const Request& request, QueryOutcome<S>& outcome,
                ContinuousContacts<S>* contacts) {
  const DefaultFloatingPoint mode;
  const PlacedGeometry<S> placed1(o1), placed2(o2);
  const Answerer answerer = answererOf(placed1, placed2);
  if (answerer == Answerer::kFcl) return false;
  const CheckedRequest checked(request);
  const Reply<S> reply{outcome, contacts};
  const auto answer = [&] {
    if (placed1.compound() || placed2.compound())
      answerCompounds(placed1, placed2, checked, reply);
    else
      answerGeometries(placed1, placed2, answerer, checked, reply);
  };
  if (checked.options.num_threads == 1) {
    answer();
    return true;
  }
  inArena(checked.options.num_threads, [&] {
    const DefaultFloatingPoint mode_of_its_thread;
    answer();
  });
  return true;
}

template <typename S>
void refuseContacts(const MovingGeometry<S>& o1, const MovingGeometry<S>& o2) {
  const DefaultFloatingPoint mode;
  const PlacedGeometry<S> placed1(o1), placed2(o2);
  const PlacedGeometry<S>& unknown = placed1.isKnown() ? placed2 : placed1;
  throw Exception(
      whyFclAnswers(placed1, placed2) + ", so FCL answers this pair, without contacts. " +
      (unknown.isMesh() || unknown.isRigid()
           ? "Derive the motion class from BoundedMotion too, or give transforms"
           : "Give a mesh, an octree or a DeformableBVHModel with free points in its "
             "place, or a ContinuousCollisionRequest: FCL then takes meshes as they are "
             "in their current frame"));
}

void refuseTransforms(const MovingGeometry<float>& o1, const MovingGeometry<float>& o2) {
  const DefaultFloatingPoint mode;
  throw Exception(whyFclAnswers(PlacedGeometry<float>(o1), PlacedGeometry<float>(o2)) +
                  ", so FCL answers this pair. In float FCL has no query between "
                  "transforms. Give TranslationMotion or SplineMotion objects in their "
                  "place, or use double");
}

template <typename S, typename Request>
void answerSelf(const CollisionGeometry<S>* o, const Request& request,
                QueryOutcome<S>& outcome, ContinuousContacts<S>* contacts) {
  require(o, "o");
  const CheckedRequest checked(request);
  QueryOptions options = checked.options;
  requireMesh(*o, "continuousSelfCollide");
  const deformable::Pose still;
  inArena(options.num_threads, [&] {
    const DefaultFloatingPoint mode;
    const PreparedMesh prepared(*o, still, still, "o", options.num_threads);
    const deformable::MeshInstance& mesh = prepared.instance();
    RequestFilter filter(checked, *o, *o, true);
    options.filter = filter.prepare(mesh, mesh);
    QueryAnswer answer =
        filteredAnswerOf(filter, [&] { return querySelf(mesh, options); });
    answer.times.update += prepared.updateTime();
    const bool is_soup = contacts && isTriangleSoup(mesh, deformable::numTrianglesOf(*o));
    Reply<S>{outcome, contacts}.give(answer, *o, *o, options, mesh, mesh);
    if (contacts) contacts->is_triangle_soup = is_soup;
  });
}

template <typename S>
bool isDeformingMesh(const CollisionGeometry<S>& o) {
  return deformable::meshKindOf(o) == deformable::MeshKind::kDeforming;
}

template <typename S>
bool isDeformableModel(const CollisionGeometry<S>& o) {
  return classCast<DeformableMesh>(o) != nullptr;
}

#define FCL_CCD_INSTANTIATE_FOR(S, Request)                                           \
  template bool answerPair(const MovingGeometry<S>&, const MovingGeometry<S>&,        \
                           const Request&, QueryOutcome<S>&, ContinuousContacts<S>*); \
  template void answerSelf(const CollisionGeometry<S>*, const Request&,               \
                           QueryOutcome<S>&, ContinuousContacts<S>*);
#define FCL_CCD_INSTANTIATE(S)                                                      \
  FCL_CCD_INSTANTIATE_FOR(S, ContinuousCollisionRequest<S>)                         \
  FCL_CCD_INSTANTIATE_FOR(S, ContinuousContactRequest<S>)                           \
  template void requireValid(const ContinuousContactRequest<S>&);                   \
  template void refuseContacts(const MovingGeometry<S>&, const MovingGeometry<S>&); \
  template bool isDeformingMesh(const CollisionGeometry<S>&);                       \
  template bool isDeformableModel(const CollisionGeometry<S>&);
FCL_CCD_INSTANTIATE(double)
FCL_CCD_INSTANTIATE(float)
#undef FCL_CCD_INSTANTIATE
#undef FCL_CCD_INSTANTIATE_FOR

}  // namespace detail
}  // namespace fcl

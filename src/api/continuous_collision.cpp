// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <limits>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "api/contact_conversion.h"
#include "base/default_floating_point.h"
#include "base/large_pages.h"
#include "base/parallel.h"
#include "base/stopwatch.h"
#include "curved/curved_contacts.h"
#include "curved/shape_contacts.h"
#include "fcl/common/exception.h"
#include "fcl/geometry/bvh/deformable_bvh_model.h"
#include "fcl/narrowphase/detail/query_numbers.h"
#include "mesh/triangle_soup.h"
#include "prepare/class_cast.h"
#include "prepare/overlapping_shapes.h"
#include "prepare/posed_flat.h"
#include "prepare/prepared_mesh.h"
#include "prepare/prepared_motion.h"
#include "prepare/query_arguments.h"
#include "prepare/query_range.h"
#include "prepare/request_filter.h"
#include "query/deformable_query.h"

namespace fcl {
namespace detail {
namespace {

using deformable::DefaultFloatingPoint;
using deformable::inArena;
using deformable::numTrianglesOf;
using deformable::PreparedMesh;
using deformable::PreparedMotion;
using deformable::QueryAnswer;
using deformable::QueryOptions;
using deformable::ShapeAnswer;

QueryOptions makeOptions(const QuerySettings& settings) {
  QueryOptions options;
  options.query = ContinuousQuery::kFirst;
  options.max_contacts = 1;
  options.toc_err = requireTocErr(settings.toc_err, "request.toc_err");
  options.only_time = !settings.with_contacts;
  if (!settings.with_contacts) return options;
  if (settings.num_max_contacts == 0)
    throw Exception(
        "request.num_max_contacts is 0. Give 1 or more, or ask with "
        "ContinuousQuery::kAny");
  options.query = settings.query;
  options.max_contacts = settings.num_max_contacts;
  if (settings.num_threads < 0)
    throw Exception(
        "request.num_threads is negative. Give a number of threads, or 0 for all "
        "threads of the task arena");
  options.num_threads = settings.num_threads;
  if (!(settings.t_max >= 0 && settings.t_max <= 1))
    throw Exception("request.t_max is " + std::to_string(settings.t_max) +
                    "; it must be in [0, 1]");
  options.t_max = settings.t_max;
  if (settings.enable_crossings && settings.query == ContinuousQuery::kAny)
    throw Exception(
        "request.enable_crossings lists all crossings, which ContinuousQuery::kAny does "
        "not look for: use kFirst or kAll");
  options.all_crossings = settings.enable_crossings;
  requireDistance(settings.min_distance, "request.min_distance");
  options.min_distance = settings.min_distance;
  if (settings.ignore_initially_closer && !(settings.min_distance > 0))
    throw Exception(
        "request.ignore_initially_closer is about pairs that are nearer than "
        "request.min_distance, which is 0. Give a distance");
  options.ignores_initially_closer = settings.ignore_initially_closer;
  return options;
}

template <typename S>
QueryOutcome<S> outcomeOf(const QueryAnswer& answer) {
  if (answer.hasCrossing()) return {true, 0, 0, 0};
  if (answer.contacts.empty()) return {false, 1, 1, 1};
  const S hi = deformable::roundTimeUp<S>(answer.first.hi);
  return {true, deformable::roundTimeDown<S>(answer.first.lo), hi, hi};
}

/// The filter of a request for two meshes that have been checked, or for one mesh with
/// itself.
template <typename S>
RequestFilter filterOf(const QuerySettings& settings, const CollisionGeometry<S>& o1,
                       const CollisionGeometry<S>& o2, bool is_self) {
  if (!settings.with_contacts) return RequestFilter();
  return RequestFilter(settings, numTrianglesOf(o1), numTrianglesOf(o2), is_self);
}

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

/// @param convert  converts a FeatureContact or a Crossing into the public type
/// @param update  seconds that boxes, owners and trees took
template <typename S, typename Convert>
void fillContacts(const QueryAnswer& answer, const QuerySettings& settings,
                  const Convert& convert, double update, ContinuousContacts<S>& result) {
  const deformable::Stopwatch start;
  const std::size_t count = answer.contacts.size();
  const auto contactAt = [&](std::size_t i) {
    // Contacts that are neighbours in time are scattered in memory.
    constexpr std::size_t kAhead = 16;
    __builtin_prefetch(&answer.contacts[std::min(i + kAhead, count - 1)]);
    return convert(answer.contacts[i]);
  };
  // Allocate first: an exception must leave the result unchanged.
  result.crossings.reserve(settings.enable_crossings ? answer.crossings.size() : 0);
  if (result.contacts.capacity() < count) {
    std::vector<ContinuousContact<S>> room;
    room.reserve(count);
    deformable::preferLargePages(room.data(), count * sizeof(ContinuousContact<S>));
    result.contacts.swap(room);
  }
  if (deformable::numThreads(settings.num_threads) == 1) {
    result.contacts.clear();
    for (std::size_t i = 0; i < count; ++i) result.contacts.push_back(contactAt(i));
  } else {
    // resize() writes each contact once, contactAt() a second time.
    constexpr std::size_t kBlock = 1024;
    result.contacts.resize(count);
    deformable::parallelForBlocks(count, kBlock, settings.num_threads,
                                  [&](std::size_t i, std::size_t last) {
                                    for (; i < last; ++i)
                                      result.contacts[i] = contactAt(i);
                                  });
  }
  result.contacts_cut = answer.cut;
  result.is_triangle_soup = false;
  result.initially_crossing = answer.hasCrossing();
  result.crossing =
      answer.hasCrossing() ? convert(answer.crossings.front()) : ContinuousContact<S>();
  result.crossings.clear();
  if (settings.enable_crossings)
    for (const auto& crossing : answer.crossings)
      result.crossings.push_back(convert(crossing));
  result.counts = answer.counts;
  result.times = answer.times;
  result.times.update += update;
  result.times.test += start.seconds();
}

/// The meshes of a query of straight paths, for the conversion of its contacts.
template <typename S>
struct QueriedMeshes {
  const CollisionGeometry<S>& o1;
  const CollisionGeometry<S>& o2;
  const PreparedMesh& mesh1;
  const PreparedMesh& mesh2;
};

template <typename S>
void fillContacts(const QueryAnswer& answer, const QueriedMeshes<S>& meshes,
                  const QuerySettings& settings, ContinuousContacts<S>& result) {
  const auto convert = [&](const auto& contact) {
    const auto &a = meshes.mesh1.instance(), &b = meshes.mesh2.instance();
    ContinuousContact<S> out;
    if constexpr (std::is_same_v<decltype(contact), const deformable::Crossing&>)
      out = deformable::toContinuousContact<S>(contact, a, b, settings.enable_contact);
    else
      out = deformable::toContinuousContact<S>(contact, a, b, settings.enable_contact,
                                               settings.min_distance > 0);
    out.o1 = &meshes.o1;
    out.o2 = &meshes.o2;
    return out;
  };
  double update = meshes.mesh1.updateTime();
  if (&meshes.mesh1 != &meshes.mesh2) update += meshes.mesh2.updateTime();
  fillContacts(answer, settings, convert, update, result);
}

/// Converts contacts and crossings to the public type, where one of the meshes turns.
template <typename S>
class MotionConverter {
 public:
  MotionConverter(const PreparedMotion& motion1, const PreparedMotion& motion2,
                  const QuerySettings& settings)
      : motion1_(motion1),
        motion2_(motion2),
        beginning1_(motion1.beginning()),
        beginning2_(motion2.beginning()),
        with_geometry_(settings.enable_contact),
        at_distance_(settings.min_distance > 0) {}

  ContinuousContact<S> operator()(const deformable::FeatureContact& contact) const {
    return deformable::toContinuousContact<S>(contact, motion1_, motion2_, with_geometry_,
                                              at_distance_);
  }
  ContinuousContact<S> operator()(const deformable::Crossing& crossing) const {
    return deformable::toContinuousContact<S>(crossing, beginning1_, beginning2_,
                                              with_geometry_);
  }

 private:
  const PreparedMotion& motion1_;
  const PreparedMotion& motion2_;
  deformable::MeshInstance beginning1_, beginning2_;
  bool with_geometry_;
  bool at_distance_;
};

/// Answers two meshes, one of which turns.
template <typename S>
void answerMotions(const PlacedGeometry<S>& o1, const PlacedGeometry<S>& o2,
                   QueryOptions options, const QuerySettings& settings,
                   QueryOutcome<S>& outcome, ContinuousContacts<S>* contacts) {
  const PreparedMotion motion1(o1, "o1", options.toc_err, options.num_threads),
      motion2(o2, "o2", options.toc_err, options.num_threads);
  RequestFilter filter = filterOf(settings, o1.geometry(), o2.geometry(), false);
  requireProvenRange(motion1, motion2);
  // Triangles stand for all their features there.
  const deformable::MeshInstance without_owners;
  options.filter = filter.prepare(without_owners, without_owners);
  const QueryAnswer answer = filteredAnswerOf(filter, [&] {
    return queryCurvedContacts(motion1.body(), motion2.body(), options);
  });
  if (contacts) {
    const MotionConverter<S> converter(motion1, motion2, settings);
    const auto convert = [&](const auto& contact) {
      auto out = converter(contact);
      out.o1 = &o1.geometry();
      out.o2 = &o2.geometry();
      return out;
    };
    fillContacts(answer, settings, convert, motion1.updateTime() + motion2.updateTime(),
                 *contacts);
  }
  outcome = outcomeOf<S>(answer);
}

template <typename S>
void fillContacts(const ShapeAnswer& answer, const PlacedGeometry<S>& o1,
                  const PlacedGeometry<S>& o2, bool with_geometry,
                  ContinuousContacts<S>& result) {
  ContinuousContacts<S> out;
  out.contacts.reserve(answer.contacts.size());
  for (const auto& contact : answer.contacts) {
    out.contacts.push_back(deformable::toContinuousContact<S>(contact, with_geometry));
    out.contacts.back().o1 = &o1.geometry();
    out.contacts.back().o2 = &o2.geometry();
  }
  out.contacts_cut = answer.cut;
  out.counts = answer.counts;
  result = std::move(out);
}

/// As in FCL, the cells of an octree meet only what the program calls occupied
/// (cost_density and threshold_occupied).
template <typename S>
bool isNoObstacleFor(const PlacedGeometry<S>& octree, const PlacedGeometry<S>& other) {
  return octree.isOctree() && !other.isOctree() && !other.geometry().isOccupied();
}

template <typename S>
ShapeAnswer scaledAnswerOf(const PlacedGeometry<S>& o1, const PlacedGeometry<S>& o2,
                           QueryOptions options, double factor, double& update);

template <typename S>
bool isUnbounded(const PlacedGeometry<S>& o) {
  return deformable::isUnbounded(o.geometry());
}

template <typename S>
ShapeAnswer boundedAnswerOf(const PlacedGeometry<S>& o1, const PlacedGeometry<S>& o2,
                            const QueryOptions& options, double scale, double& update) {
  // The part of an unbounded shape that matters depends on the other object.
  const bool second_first = isUnbounded(o1);
  const PreparedMotion bounded(second_first ? o2 : o1, second_first ? "o2" : "o1",
                               options.toc_err, options.num_threads, 0, scale),
      other(second_first ? o1 : o2, second_first ? "o1" : "o2", options.toc_err,
            options.num_threads, bounded.isEmpty() ? 0 : bounded.body().size(), scale);
  if (bounded.isEmpty() || other.isEmpty()) return {};
  const PreparedMotion &motion1 = second_first ? other : bounded,
                       &motion2 = second_first ? bounded : other;
  if (scale == 1) {
    const double factor =
        scaleOf(o1.moving(), motion1, o2.moving(), motion2, options.min_distance);
    if (factor != 1) return scaledAnswerOf(o1, o2, options, factor, update);
  }
  update = bounded.updateTime() + other.updateTime();
  return answerOf(
      [&] { return queryShapeContacts(motion1.body(), motion2.body(), options); });
}

/// Two shapes whose lengths are multiplied by a power of two: this changes no digit.
template <typename S>
ShapeAnswer scaledAnswerOf(const PlacedGeometry<S>& o1, const PlacedGeometry<S>& o2,
                           QueryOptions options, double factor, double& update) {
  const MovingGeometry<S> moving1 = scaledPath(o1.moving(), factor),
                          moving2 = scaledPath(o2.moving(), factor);
  options.min_distance *= factor;
  ShapeAnswer answer = boundedAnswerOf(
      PlacedGeometry<S>(moving1), PlacedGeometry<S>(moving2), options, factor, update);
  for (auto& contact : answer.contacts)
    contact.position = (1 / factor) * contact.position;
  return answer;
}

template <typename S>
ShapeAnswer shapeAnswerOf(const PlacedGeometry<S>& o1, const PlacedGeometry<S>& o2,
                          const QueryOptions& options, double& update) {
  if (isNoObstacleFor(o1, o2) || isNoObstacleFor(o2, o1)) return {};
  if (isUnbounded(o1) && isUnbounded(o2))
    return queryFlats(deformable::posedFlatOf(o1, "o1"),
                      deformable::posedFlatOf(o2, "o2"), options);
  return boundedAnswerOf(o1, o2, options, 1, update);
}

/// Answers a shape or an octree, and another one of these or a mesh.
template <typename S>
void answerShapes(const PlacedGeometry<S>& o1, const PlacedGeometry<S>& o2,
                  QueryOptions options, const QuerySettings& settings,
                  QueryOutcome<S>& outcome, ContinuousContacts<S>* contacts) {
  // The first contact that is found is the first of all.
  if (!settings.with_contacts) options.query = ContinuousQuery::kAny;
  RequestFilter filter = filterOf(settings, o1.geometry(), o2.geometry(), false);
  const deformable::MeshInstance without_owners;
  options.filter = filter.prepare(without_owners, without_owners);
  const deformable::Stopwatch start;
  double update = 0;
  ShapeAnswer answer;
  if (!filter.rejectsAll()) answer = shapeAnswerOf(o1, o2, options, update);
  outcome = {false, 1, 1, 1};
  if (!answer.contacts.empty()) {
    const auto& first = answer.contacts.front();
    const S hi = deformable::roundTimeUp<S>(first.toc_hi);
    outcome = {true, deformable::roundTimeDown<S>(first.toc_lo), hi,
               std::max(hi, static_cast<S>(answer.pose_time))};
  }
  if (!contacts) return;
  fillContacts(answer, o1, o2, settings.enable_contact, *contacts);
  contacts->times.update = update;
  contacts->times.test = start.seconds() - update;
}

}  // namespace

template <typename S>
bool answerPair(const MovingGeometry<S>& o1, const MovingGeometry<S>& o2,
                const QuerySettings& settings, QueryOutcome<S>& outcome,
                ContinuousContacts<S>* contacts) {
  const DefaultFloatingPoint mode;
  if (!settings.with_contacts && areOverlappingShapes(o1, o2)) {
    requireTocErr(settings.toc_err, "request.toc_err");
    outcome = {true, 0, 0, 0};
    return true;
  }
  const PlacedGeometry<S> placed1(o1), placed2(o2);
  const Answerer answerer = answererOf(placed1, placed2);
  if (answerer == Answerer::kFcl) return false;
  QueryOptions options = makeOptions(settings);
  const auto answer_pair = [&] {
    if (answerer == Answerer::kCurvedPaths)
      return answerMotions(placed1, placed2, options, settings, outcome, contacts);
    if (answerer == Answerer::kShapes)
      return answerShapes(placed1, placed2, options, settings, outcome, contacts);
    const PreparedMesh mesh1(placed1.geometry(), placed1.beginning(), placed1.end(), "o1",
                             options.num_threads);
    const PreparedMesh mesh2(placed2.geometry(), placed2.beginning(), placed2.end(), "o2",
                             options.num_threads);
    RequestFilter filter = filterOf(settings, *o1.geometry, *o2.geometry, false);
    options.filter = filter.prepare(mesh1.instance(), mesh2.instance());
    const QueryAnswer answer = filteredAnswerOf(
        filter, [&] { return queryPair(mesh1.instance(), mesh2.instance(), options); });
    if (contacts)
      fillContacts(answer, QueriedMeshes<S>{*o1.geometry, *o2.geometry, mesh1, mesh2},
                   settings, *contacts);
    outcome = outcomeOf<S>(answer);
  };
  if (options.num_threads == 1) {
    answer_pair();
    return true;
  }
  inArena(options.num_threads, [&] {
    const DefaultFloatingPoint mode_of_its_thread;
    answer_pair();
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

template <typename S>
void answerSelf(const CollisionGeometry<S>* o, const QuerySettings& settings,
                QueryOutcome<S>& outcome, ContinuousContacts<S>* contacts) {
  require(o, "o");
  QueryOptions options = makeOptions(settings);
  requireMesh(*o, "continuousSelfCollide");
  const deformable::Pose still;
  inArena(options.num_threads, [&] {
    const DefaultFloatingPoint mode;
    const PreparedMesh mesh(*o, still, still, "o", options.num_threads);
    RequestFilter filter = filterOf(settings, *o, *o, true);
    options.filter = filter.prepare(mesh.instance(), mesh.instance());
    const QueryAnswer answer =
        filteredAnswerOf(filter, [&] { return querySelf(mesh.instance(), options); });
    if (contacts) {
      const bool is_soup = isTriangleSoup(mesh.instance(), numTrianglesOf(*o));
      fillContacts(answer, QueriedMeshes<S>{*o, *o, mesh, mesh}, settings, *contacts);
      contacts->is_triangle_soup = is_soup;
    }
    outcome = outcomeOf<S>(answer);
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

#define FCL_CCD_INSTANTIATE(S)                                                      \
  template bool answerPair(const MovingGeometry<S>&, const MovingGeometry<S>&,      \
                           const QuerySettings&, QueryOutcome<S>&,                  \
                           ContinuousContacts<S>*);                                 \
  template void refuseContacts(const MovingGeometry<S>&, const MovingGeometry<S>&); \
  template void answerSelf(const CollisionGeometry<S>*, const QuerySettings&,       \
                           QueryOutcome<S>&, ContinuousContacts<S>*);               \
  template bool isDeformingMesh(const CollisionGeometry<S>&);                       \
  template bool isDeformableModel(const CollisionGeometry<S>&);
FCL_CCD_INSTANTIATE(double)
FCL_CCD_INSTANTIATE(float)
#undef FCL_CCD_INSTANTIATE

}  // namespace detail
}  // namespace fcl

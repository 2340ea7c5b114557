// SPDX-License-Identifier: BSD-3-Clause
#include "curved/chord_pairs.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "advance/triangle_advance.h"
#include "bodies/body_side.h"
#include "numerics/error_bounds.h"
#include "paths/posed_vector.h"
#include "paths/sine.h"
#include "query/deformable_query.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

/// Whether all points are accelerated alike, so that their chords can be moved
/// (centerChords()) or bent (bendOf()).
bool turnsAsOne(const MovingBody& body) { return body.isRigid() && body.path().axis(); }

/// Moves the chords of a turn in a span to the middle of what the paths deviate from
/// them. In the middle of the span these deviate by about -p'' dt^2 / 8 from the chords
/// between their ends, elsewhere by less, all to the same side. From chords that are
/// moved by half of it they deviate by M dt^2 / 16, and by half of the change of p'', at
/// most w M dt / 2, times dt^2 / 8.
void centerChords(const MotionPath& path, double t0, double t1, Pose (&pose)[2]) {
  const PoseRate bend = path.turnAccelerationAt(0.5 * (t0 + t1));
  const double share = (t1 - t0) * (t1 - t0) / 16;
  for (Pose& end : pose) {
    for (int i = 0; i < 9; ++i) end.rotation[i] -= share * bend.rotation[i];
    for (int k = 0; k < 3; ++k) end.translation[k] -= share * bend.translation[k];
  }
}

/// Bound on the deviation of the vertices from chords of the whole step that are not
/// moved.
double deviationOf(const MovingBody& body) {
  BodySide side(body);
  if (side.goes_straight) return 0;
  const BodyPart root = body.root();
  const BodyBox begin = body.box(root, 0),
                end = body.isRigid() ? begin : body.box(root, 1);
  return 0.125 * side.accelerationOf(begin, end, 0, 1);
}

/// A triangle of the mesh below children that a number chooses; the sum of its edges.
double sampledPerimeter(const MovingBody& body, int number) {
  BodyNode node;
  BodyPart part = body.root();
  for (int depth = 0; !part.isTriangle(); ++depth) {
    body.open(part, node);
    part = node.part[(3 * number + 5 * depth) % node.count];
  }
  if (!body.isReadable(~part.child)) return 0;
  const BodyTriangle triangle = body.triangle(~part.child);
  double sum = 0;
  for (int k = 0; k < 3; ++k)
    sum += norm(triangle.corner[0][(k + 1) % 3] - triangle.corner[0][k]);
  return sum;
}

/// About the mean length of an edge of the mesh, from a few triangles. Those without
/// extent beside the mesh do not count, unless no other one is found.
double sampledEdge(const MovingBody& body) {
  constexpr int kSamples = 8, kMostRounds = 16;
  constexpr double kNoExtent = 0x1p-20;
  const double least = kNoExtent * body.box(body.root(), 0).radius;
  double largest = 0;
  for (int round = 0; round < kMostRounds; ++round) {
    double sum = 0;
    int count = 0;
    for (int i = 0; i < kSamples; ++i) {
      const double perimeter = sampledPerimeter(body, kSamples * round + i);
      largest = std::max(largest, perimeter);
      if (!(perimeter > least)) continue;
      sum += perimeter;
      ++count;
    }
    if (count > 0) return sum / (3 * count);
  }
  return largest / 3;
}

/// The center of a body at a time, in the world, and the radius around it.
Vec centerAt(const MovingBody& body, double t, double& radius) {
  const BodyPart root = body.root();
  const BodyBox begin = body.box(root, 0),
                end = body.isRigid() ? begin : body.box(root, 1);
  radius = (begin.pad + end.pad) + std::max(begin.radius, end.radius);
  return posed(body.path().pose(t), vecOf(begin.center), vecOf(end.center), t);
}

}  // namespace

// The path of a point with the acceleration p'' is at the chord minus p'' t (1 - t) dt^2
// / 2 as long as p'' does not change. So the bend is -p'' dt^2 / 8, taken in the middle
// of the span. p'' changes by at most w M |s - 1/2| dt from there, with M the bound on
// it and w the angle. The integral of that with Green's function of p'' is largest in
// the middle, where it is w M dt^3 / 48: w dt / 6 of the bound M dt^2 / 8.
//
// With the axis a, p'' is -w^2 (I - a a^T) of the distance from a point on the axis. The
// middle of a chord is nearer to it, by the cosine of w dt / 2. What the product with
// the middle of the chord leaves over is rounding, but for matrices that are no
// rotations; it is measured.
ChordBend bendOf(const MotionPath& path, double radius, double t0, double t1,
                 double most) {
  assert(0 <= t0 && t0 < t1 && t1 <= 1 && radius >= 0 && most >= 0);
  assert(path.axis() && path.turn());
  const PoseRate change = path.turnAccelerationAt(0.5 * (t0 + t1));
  const Pose from = path.pose(t0), to = path.pose(t1);
  const Vec& a = *path.axis();
  const double axis[3] = {a.x, a.y, a.z}, dt = t1 - t0, share = dt * dt / 8,
               angle = path.turn()->angle * dt,
               factor = 0.125 * angle * angle / sineCosine(0.5 * angle).cosine;
  assert(0 <= angle && angle < 3.14159 && factor >= 0);
  ChordBend out{};
  double(&m)[9] = out.bend.matrix;
  double square = 0, size = 0;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      m[3 * i + j] = factor * ((i == j ? 1 : 0) - axis[i] * axis[j]);
  for (int i = 0; i < 3; ++i) {
    out.bend.offset[i] = -share * change.translation[i];
    for (int k = 0; k < 3; ++k) {
      const double middle = 0.5 * (from.translation[k] + to.translation[k]);
      out.bend.offset[i] -= m[3 * i + k] * middle;
      size += std::abs(m[3 * i + k]) * std::abs(middle);
    }
    for (int j = 0; j < 3; ++j) {
      double rest = -share * change.rotation[3 * i + j];
      for (int k = 0; k < 3; ++k)
        rest -= m[3 * i + k] * 0.5 * (from.rotation[3 * k + j] + to.rotation[3 * k + j]);
      square += rest * rest;
    }
  }
  // The share of `most` and of the sizes is more than all roundings: of p'', which is
  // within 2^-46 of its bound, and of a few sums of products.
  out.error =
      std::sqrt(square) * radius + angle / 6 * most +
      0x1p-42 * (most + size +
                 3 * factor * (path.largestTranslation() + path.stretch() * radius));
  assert(out.error >= 0);
  return out;
}

bool ChordMesh::isRefit(double t0, double t1) const {
  const MotionPath& path = body_.path();
  const bool is_whole_step = t0 == 0 && t1 == 1;
  return !body_.isRigid() &&
         !(is_whole_step && path.isTranslation() && path.pose(0).isTranslation());
}

// At t = 0 the vertices are posed as by VertexFrames, so that crossings are decided as
// those of meshes that go straight. Later chords may be moved.
const MeshInstance& ChordMesh::during(double t0, double t1, int num_threads,
                                      const Bend* bend) {
  assert(0 <= t0 && t0 < t1 && t1 <= 1 && (!bend || turnsAsOne(body_)));
  mesh_ = body_.meshInBodyFrame();
  mesh_.bend = bend;
  const MotionPath& path = body_.path();
  Pose pose[2] = {path.pose(t0), path.pose(t1)};
  if (t0 > 0 && !bend && turnsAsOne(body_)) centerChords(path, t0, t1, pose);
  if (!isRefit(t0, t1)) {
    // Where vertices are posed already, the path is the identity (PreparedMotion).
    if (!mesh_.frames.isPosed()) mesh_.frames.setPoses(pose[0], pose[1]);
    if (!mesh_.tree) mesh_.rigid = mesh_.rigid.turned(pose[0], pose[1]);
    for (auto frame : {0, 1})
      std::copy(pose[frame].translation, pose[frame].translation + 3,
                mesh_.translation[frame]);
    if (bend) mesh_.rigid.setBend(*bend, mesh_.translation);
    return mesh_;
  }
  const VertexFrames& frames = mesh_.frames;
  for (auto frame : {0, 1}) {
    const double t = frame == 0 ? t0 : t1;
    coordinates_[frame].resize(3 * frames.size());
    double* out = coordinates_[frame].data();
    for (std::size_t i = 0; i < frames.size(); ++i) {
      const VertexPath x = frames[i];
      for (int k = 0; k < 3; ++k) *out++ = (1 - t) * x.t0[k] + t * x.t1[k];
    }
  }
  mesh_.frames =
      VertexFrames(coordinates_[0].data(), coordinates_[1].data(), frames.size());
  mesh_.frames.setPoses(pose[0], pose[1]);
  assert(mesh_.tree);
  if (tree_.triangles().empty()) tree_ = *mesh_.tree;
  tree_.refit(mesh_.frames, num_threads);
  mesh_.tree = &tree_;
  return mesh_;
}

bool ChordSearch::isFor(const MovingBody& a, const MovingBody& b,
                        const QueryOptions& options) {
  // A smaller mesh is compared quickly either way.
  constexpr std::size_t kLeastVertices = 256;
  return a.isMesh() && b.isMesh() && options.query == ContinuousQuery::kAll &&
         !options.filter && !options.only_time && !options.ignores_initially_closer &&
         std::min(a.numVertices(), b.numVertices()) >= kLeastVertices && !a.hasFree() &&
         !b.hasFree();
}

// In a span of length s the deviation is s^2 of that of the whole step. Spans are so
// short that it is a small part of an edge: then few pairs come near that do not touch.
// With bends only boxes are larger by the deviation, so that it may be a larger part of
// an edge. Bends have their cost: they pay if they save a span or make boxes much
// smaller. Below kLeastBent of an edge they do neither, and cost up to 4% of the time.
ChordSearch::ChordSearch(const MovingBody& a, const MovingBody& b,
                         const QueryOptions& options)
    : body_{&a, &b}, options_(options), mesh_{ChordMesh(a), ChordMesh(b)} {
  constexpr double kMostOfEdge = 0x1p-4, kMostOfBentEdge = 0x1p-2, kLeastBent = 0x1p-7;
  assert(isFor(a, b, options));
  for (auto k : {0, 1}) whole_[k] = deviationOf(*body_[k]) * kUpward;
  const double edge = std::min(sampledEdge(a), sampledEdge(b));
  has_bends_ = listsWindows() && whole_[0] + whole_[1] > kLeastBent * edge;
  const auto shareOf = [&](int k) {
    return whole_[k] / ((isBent(k) ? kMostOfBentEdge : kMostOfEdge) * edge);
  };
  num_spans_ = enoughSpans(shareOf(0) + shareOf(1));
  // What is within the tolerance counts as contact. A chord has the error of its ends.
  const BodyTolerance tolerance(a, b, options.min_distance);
  error_ = tolerance.touching + tolerance.position;
  assert(0 <= num_spans_ && error_ >= 0 && !(whole_[0] < 0) && !(whole_[1] < 0));
}

// A few spans are a power of two, so that their ends are dyadic. More than these are as
// many as are needed: their number, and with it the time of a query, grows in proportion
// to the angle of a turn. A span in which the meshes are apart takes less than a
// microsecond. Meshes that need more than the most have edges of less than 2^-24 of their
// way, or of half of it without bends.
int ChordSearch::enoughSpans(double share) const {
  constexpr int kMostDyadic = 16, kMostSpans = 4096;
  // bendOf() needs less than pi in a span.
  constexpr double kMostTurn = 2.5;
  if (!(share <= double{kMostSpans} * kMostSpans)) return 0;
  int count = 1;
  for (auto k : {0, 1})
    while (isBent(k) && body_[k]->path().turn()->angle >= kMostTurn * count) count *= 2;
  while (count <= kMostDyadic && !(share <= static_cast<double>(count) * count))
    count *= 2;
  return count <= kMostDyadic ? count : static_cast<int>(std::ceil(std::sqrt(share)));
}

bool ChordSearch::isBent(int k) const { return has_bends_ && turnsAsOne(*body_[k]); }

/// Bound on the deviation of a mesh from its chords in a span.
double ChordSearch::deviationIn(int k, const Span& span) const {
  const double dt = span.t1 - span.t0;
  const bool is_centered = span.t0 > 0 && !isBent(k) && turnsAsOne(*body_[k]);
  const double share = is_centered ? 0.5 + 0.5 * body_[k]->path().turn()->angle * dt : 1;
  return share * whole_[k] * dt * dt;
}

bool ChordSearch::listsWindows() const {
  return !(options_.min_distance > 0) && body_[0]->path().turn() &&
         body_[1]->path().turn();
}

// To interpolate, pose and refit takes about as long for a vertex as half a box test.
std::uint64_t ChordSearch::boxTestsBefore() const {
  if (num_spans_ == 0) return ~std::uint64_t{0};
  std::uint64_t tests = 0;
  for (auto k : {0, 1})
    if (mesh_[k].isRefit(0, 1. / num_spans_))
      tests += static_cast<std::uint64_t>(num_spans_) * body_[k]->numVertices() / 2;
  return tests;
}

/// Whether balls around the bodies may come within the distance.
bool ChordSearch::mayMeet(double t0, double t1, double deviation) const {
  const double middle = 0.5 * (t0 + t1);
  double radius[2];
  const Vec from = centerAt(*body_[0], middle, radius[0]),
            to = centerAt(*body_[1], middle, radius[1]);
  const double stretch = std::max(body_[0]->path().stretch(), body_[1]->path().stretch());
  const double most = stretch * (radius[0] + radius[1]) + options_.min_distance +
                      deviation +
                      0.5 * (t1 - t0) * (body_[0]->speed() + body_[1]->speed());
  return !(norm(to - from) > most * kUpward);
}

ChordSearch::Span ChordSearch::find(int i) {
  assert(0 <= i && i < num_spans_);
  Span span;
  span.t0 = static_cast<double>(i) / num_spans_;
  span.t1 = static_cast<double>(i + 1) / num_spans_;
  assert(0 <= span.t0 && span.t0 < span.t1 && span.t1 <= 1);
  const double deviation[2] = {deviationIn(0, span), deviationIn(1, span)};
  if (span.t0 > options_.t_max ||
      !mayMeet(span.t0, span.t1, (deviation[0] + deviation[1] + error_) * kUpward))
    return span;
  QueryOptions near = options_;
  double add = error_;
  ChordBend bends[2];
  for (auto k : {0, 1}) {
    if (isBent(k)) {
      bends[k] =
          bendOf(body_[k]->path(), body_[k]->radius(), span.t0, span.t1, deviation[k]);
      add += bends[k].error;
    } else {
      add += deviation[k];
    }
  }
  near.min_distance = (options_.min_distance + add * kUpward) * kUpward;
  near.max_contacts = static_cast<std::size_t>(-1);
  near.t_max = std::min(1., (options_.t_max - span.t0) / (span.t1 - span.t0) * kUpward);
  near.all_crossings &= i == 0;
  assert(near.min_distance >= options_.min_distance);
  assert(0 <= near.t_max && near.t_max <= 1);
  // A bracket need not be narrow.
  near.toc_err = 1;
  near.names_parts = false;
  near.lists_near_pairs = listsWindows();
  const auto meshOf = [&](int k) -> const MeshInstance& {
    return mesh_[k].during(span.t0, span.t1, options_.num_threads,
                           isBent(k) ? &bends[k].bend : nullptr);
  };
  span.near = queryPair(meshOf(0), meshOf(1), near);
  if (i > 0) span.near.crossings.clear();
  return span;
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

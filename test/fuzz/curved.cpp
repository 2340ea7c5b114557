// SPDX-License-Identifier: BSD-3-Clause
//
// Meshes that turn, shapes and octrees, against samples of the exact paths in Real and
// against bounds on the distance at the times that the library gives
// (convex_piece.h). The promise is that of doc/numerics.md: none is missed, none is late,
// none is further apart than the tolerance.
#include <algorithm>
#include <cmath>
#include <sstream>

#include "curved_body.h"
#include "family.h"
#include "fcl/narrowphase/continuous_collision.h"
#include "minimise.h"

namespace fcl {
namespace test {
namespace {

using Request = ContinuousContactRequest<double>;
using Result = ContinuousContactResult<double>;
constexpr double kTocErr = 1e-5;

struct CurvedCase {
  CurvedBody a, b;
  double distance{0};
};

/// About how fast points of a body go.
Real speedOf(const CurvedBody& body, const std::pair<RealVector, Real>& ball) {
  constexpr int kTimes = 16;
  Real most = 0;
  RealPose before = body.path.exact(0);
  for (int i = 1; i <= kTimes; ++i) {
    const RealPose now = body.path.exact(static_cast<Real>(i) / kTimes);
    const Real way = (now.rotation * ball.first + now.translation -
                      before.rotation * ball.first - before.translation)
                         .norm();
    const Real turn = (now.rotation - before.rotation).norm();
    most = std::max<Real>(most, kTimes * (way + turn * std::min<Real>(ball.second, 2)));
    before = now;
  }
  return Real{1.2L} * most + Real{0.3L};
}

/// The bounds on the distance of two pieces.
GapAt gapOf(const CurvedCase& what, std::size_t i, std::size_t k) {
  return [&what, i, k](Real t) -> GapBounds {
    const RealPose x = what.a.path.exact(t), y = what.b.path.exact(t);
    const auto &p = what.a.balls[i], &q = what.b.balls[k];
    const Real middles = (x.rotation * p.first + x.translation - y.rotation * q.first -
                          y.translation)
                             .norm(),
               radii = p.second + q.second;
    if (middles > radii + 0.2L + what.distance) return {middles - radii, middles + radii};
    return gapBounds(what.a.at(i, x, t), what.b.at(k, y, t));
  };
}

using Contact = ContinuousContact<double>;

bool areMeshes(const CurvedCase& what) {
  return what.a.kind == CurvedBody::Kind::kMesh && what.b.kind == CurvedBody::Kind::kMesh;
}

/// The ids of the vertices that a contact of two meshes has of one of them.
std::vector<int> idsOf(const Contact& c, bool of_o1) {
  const int first = c.kind == ContinuousContactKind::kEdgeEdge ? 2 : 1;
  const auto ids = c.vertices.begin();
  const bool is_first = c.first_on_o1 == of_o1;
  return is_first ? std::vector<int>(ids, ids + first)
                  : std::vector<int>(ids + first, ids + c.numVertices());
}

ConvexPiece featureOf(const MovingMesh& mesh, const std::vector<int>& ids) {
  ConvexPiece piece;
  for (const int id : ids) {
    piece.t0.push_back(mesh.t0[static_cast<std::size_t>(id)].cast<Real>());
    piece.t1.push_back(mesh.t1[static_cast<std::size_t>(id)].cast<Real>());
  }
  return piece;
}

/// The lower bound at toc_lo; of two meshes that of the features that are named. If both
/// go straight, the answer is exact: the features touch somewhere in the bracket.
Real gapAtBegin(const CurvedCase& what, const Contact& c) {
  if (!areMeshes(what))
    return gapOf(what, what.a.pieceOf(c.b1), what.b.pieceOf(c.b2))(c.toc_lo).lower;
  const ConvexPiece p = featureOf(what.a.mesh, idsOf(c, true)),
                    q = featureOf(what.b.mesh, idsOf(c, false));
  const auto gap = [&](Real t) {
    const RealPose x = what.a.path.exact(t), y = what.b.path.exact(t);
    return gapBounds({&p, x.rotation, x.translation, t},
                     {&q, y.rotation, y.translation, t});
  };
  if (!what.a.path.is_straight || !what.b.path.is_straight) return gap(c.toc_lo).lower;
  const Real width = c.toc_hi - c.toc_lo;
  return sampleStep([&](Real s) { return gap(c.toc_lo + s * width); }, 9 * width, 0)
      .least;
}

/// Whether a contact is about two pieces. Of two meshes it names features, and any of
/// the triangles that have them.
bool isAbout(const CurvedCase& what, const Contact& c, std::size_t i, std::size_t k) {
  if (!areMeshes(what)) return what.a.pieceOf(c.b1) == i && what.b.pieceOf(c.b2) == k;
  const auto has = [](const MovingMesh& mesh, std::size_t triangle,
                      const std::vector<int>& ids) {
    return std::all_of(ids.begin(), ids.end(), [&](int id) {
      const Triangle& t = mesh.triangles[triangle];
      const auto v = static_cast<std::size_t>(id);
      return t[0] == v || t[1] == v || t[2] == v;
    });
  };
  return has(what.a.mesh, i, idsOf(c, true)) && has(what.b.mesh, k, idsOf(c, false));
}

/// The least bound at toc_hi. A plain BVHModel has no owners of features: its contacts
/// name one pair of triangles that have them, and another one may cross at toc_hi.
Real leastAtEnd(const CurvedCase& what, const Contact& c) {
  Real least = gapOf(what, what.a.pieceOf(c.b1), what.b.pieceOf(c.b2))(c.toc_hi).lower;
  if (!areMeshes(what)) return least;
  for (std::size_t i = 0; i < what.a.pieces.size(); ++i)
    for (std::size_t k = 0; k < what.b.pieces.size(); ++k)
      if (least > 0 && isAbout(what, c, i, k))
        least = std::min<Real>(least, gapOf(what, i, k)(c.toc_hi).lower);
  return least;
}

Real sizeOf(const CurvedBody& body, const RealVector& origin) {
  Real most = 0, way = 0;
  for (const ConvexPiece& piece : body.pieces) most = std::max<Real>(most, piece.reach());
  for (int i = 0; i <= 8; ++i)
    way = std::max<Real>(
        way, (body.path.exact(static_cast<Real>(i) / 8).translation - origin).norm());
  return most + way + body.path.more_size;
}

bool isFlat(const CurvedBody& body) { return body.pieces[0].isFlat(); }

/// tau of doc/numerics.md, whose table says "about": twice of it. It has no bound that
/// holds for a plane or halfspace beside a TwistMotion, where 3.6 times of it was seen:
/// 1e-10 of the size shows what is plainly wrong.
Real toleranceOf(const CurvedCase& what) {
  const RealVector origin =
      (what.a.path.exact(0).translation + what.b.path.exact(0).translation) / 2;
  const Real size = sizeOf(what.a, origin) + sizeOf(what.b, origin);
  const bool has_flat = isFlat(what.a) || isFlat(what.b);
  if (has_flat && (what.a.path.is_twist || what.b.path.is_twist)) return 1e-10L * size;
  const double units = std::max(what.a.path.tolerance, what.b.path.tolerance) + 130;
  Real tau = 0x1p-53L * (units * size + 32 * what.distance);
  if (has_flat) tau += 2e-13L * size;
  tau *= 2;
  if (areMeshes(what) && what.distance > 0)
    tau += 1e-9L * what.distance + 0x1p-53L * 576 * (what.distance + size);
  return tau;
}

Result ask(const CurvedCase& what, ContinuousQuery query, Outcome& outcome) {
  Request request;
  request.query = query;
  request.toc_err = kTocErr;
  request.min_distance = what.distance;
  Result result;
  outcome.timed([&] {
    return continuousCollide(what.a.geometry.get(), what.a.path.motion.get(),
                             what.b.geometry.get(), what.b.path.motion.get(), request,
                             result);
  });
  outcome.addToDigest(result.is_collide ? result.time_of_contact : 2);
  for (const auto& c : result.contacts) outcome.addToDigest(c.toc_lo);
  applyPlantedFault(result.contacts);
  if (plantedFault() == PlantedFault::kDropped && result.contacts.empty())
    result.is_collide = false;
  return result;
}

std::string told(const char* what, std::size_t i, std::size_t k, double toc, Real truth) {
  std::ostringstream out;
  out.precision(17);
  out << what << ": pieces " << i << " and " << k << ", time " << toc << ", reference "
      << static_cast<double>(truth) << "\n";
  return out.str();
}

/// Each contact that is listed is one, at its times.
void expectListed(const CurvedCase& what, const Result& result,
                  const std::vector<std::vector<Sampled>>& truth, Outcome& outcome) {
  const Real tau = toleranceOf(what);
  for (const auto& c : result.contacts) {
    const std::size_t i = what.a.pieceOf(c.b1), k = what.b.pieceOf(c.b2);
    const Real lo = gapAtBegin(what, c);
    // Of straight paths it is the end of the bracket, not a proof.
    const bool is_proof =
        !c.within_tolerance &&
        !(areMeshes(what) && what.a.path.is_straight && what.b.path.is_straight);
    const Real hi = is_proof ? leastAtEnd(what, c) : 0;
    if (lo > what.distance + tau)
      outcome.blame(truth[i][k].first <= 1 ? &Outcome::early : &Outcome::invented,
                    told("apart at toc_lo", i, k, c.toc_lo, lo - what.distance));
    // An overlap that the library proves may be less deep than the reference sees.
    if (hi > what.distance + tau)
      outcome.blame(&Outcome::invented,
                    told("apart at toc_hi", i, k, c.toc_hi, hi - what.distance));
    if (!(c.toc_hi - c.toc_lo <= kTocErr))
      outcome.blame(&Outcome::early, told("wide bracket", i, k, c.toc_lo, c.toc_hi));
  }
}

/// Each pair that the samples find is listed, and not later.
void expectPair(const CurvedCase& what, const Result& result, std::size_t i,
                std::size_t k, Real time, Outcome& outcome) {
  if (areMeshes(what) && gapOf(what, i, k)(0).upper == 0) {
    // Triangles that cross at t = 0 need not have a contact.
    if (!result.initially_crossing)
      outcome.blame(&Outcome::missed, told("crossing at t = 0", i, k, 2, 0));
    return;
  }
  double toc = 2;
  for (const Contact& c : result.contacts)
    if (isAbout(what, c, i, k)) toc = std::min(toc, c.toc_lo);
  if (toc > 1)
    outcome.blame(&Outcome::missed, told("missed", i, k, toc, time));
  else if (toc > time + 1e-15L)
    outcome.blame(&Outcome::late, told("late", i, k, toc, time));
}

void expectFound(const CurvedCase& what, const Result& result,
                 const std::vector<std::vector<Sampled>>& truth, Outcome& outcome) {
  for (std::size_t i = 0; i < truth.size(); ++i)
    for (std::size_t k = 0; k < truth[i].size(); ++k) {
      const Real time = truth[i][k].first;
      if (time > 1) continue;
      ++outcome.contacts;
      expectPair(what, result, i, k, time, outcome);
      if (!result.is_collide || result.time_of_contact > time + 1e-15L)
        outcome.blame(result.is_collide ? &Outcome::late : &Outcome::missed,
                      told("time of contact", i, k, result.time_of_contact, time));
    }
}

std::vector<std::vector<Sampled>> sampled(const CurvedCase& what) {
  std::vector<std::vector<Sampled>> truth(what.a.pieces.size());
  std::vector<Real> speeds;
  for (const auto& ball : what.b.balls) speeds.push_back(speedOf(what.b, ball));
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const Real speed = speedOf(what.a, what.a.balls[i]);
    for (std::size_t k = 0; k < what.b.pieces.size(); ++k)
      truth[i].push_back(sampleStep(gapOf(what, i, k), speed + speeds[k], what.distance));
  }
  return truth;
}

Outcome checked(const CurvedCase& what) {
  Outcome outcome;
  const auto truth = sampled(what);
  const Result all = ask(what, ContinuousQuery::kAll, outcome);
  expectListed(what, all, truth, outcome);
  expectFound(what, all, truth, outcome);
  const Result first = ask(what, ContinuousQuery::kFirst, outcome);
  if (first.is_collide != all.is_collide)
    outcome.blame(&Outcome::missed,
                  "the query for the first contact decides otherwise\n");
  expectListed(what, first, truth, outcome);
  for (const auto& row : truth)
    for (const Sampled& pair : row)
      if (pair.first <= 1 && first.time_of_contact > pair.first + 1e-15L)
        outcome.blame(&Outcome::late,
                      told("first: late", 0, 0, first.time_of_contact, pair.first));
  return outcome;
}

/// Half of the cases hit or miss by 1e-2 to 1e-9: at the least distance, or a bit more.
void graze(CurvedCase& what, Random& random) {
  Real least = 9;
  for (const auto& row : sampled(what))
    for (const Sampled& pair : row) least = std::min<Real>(least, pair.least);
  const double by = (random.index(2) ? 1 : -1) * std::pow(10, random.uniform(-9, -2));
  if (least > 1e-3L && least < 2)
    what.distance = std::max(1e-4, static_cast<double>(least) + by);
}

Outcome answered(CurvedCase what, Random& random) {
  if (random.index(2)) graze(what, random);
  Outcome outcome = checked(what);
  if (outcome.isRight() || plantedFault() != PlantedFault::kNone) return outcome;
  for (CurvedBody* body : {&what.a, &what.b}) {
    const auto still_fails = [&] {
      if (body->mesh.triangles.empty() && body->cells.empty()) return false;
      body->build();
      return !checked(what).isRight();
    };
    minimise(body->mesh.triangles, still_fails);
    minimise(body->cells, still_fails);
    body->build();
  }
  std::ostringstream test;
  test << std::hexfloat << "  request.min_distance = " << what.distance << ";\n";
  outcome.complaint =
      checked(what).complaint + what.a.code("a") + what.b.code("b") + test.str();
  return outcome;
}

Outcome turningMeshes(std::uint64_t seed) {
  Random random(seed);
  CurvedCase what{randomMeshBody(random), randomMeshBody(random)};
  return answered(std::move(what), random);
}

Outcome shapes(std::uint64_t seed) {
  Random random(seed);
  CurvedCase what{randomShapeBody(random, true), {}};
  const bool with_mesh = random.index(4) == 0;
  what.b = with_mesh ? randomMeshBody(random) : randomShapeBody(random, !isFlat(what.a));
  if (random.index(2)) std::swap(what.a, what.b);
  return answered(std::move(what), random);
}

Outcome octrees(std::uint64_t seed) {
  Random random(seed);
  CurvedCase what{randomOctreeBody(random), {}};
  const std::size_t other = random.index(3);
  what.b = other == 0   ? randomMeshBody(random)
           : other == 1 ? randomShapeBody(random, true)
                        : randomOctreeBody(random);
  if (random.index(2)) std::swap(what.a, what.b);
  return answered(std::move(what), random);
}

const RegisteredFamily kTurning("turning-meshes", turningMeshes);
const RegisteredFamily kShapes("shapes", shapes);
const RegisteredFamily kOctrees("octrees", octrees);

}  // namespace
}  // namespace test
}  // namespace fcl

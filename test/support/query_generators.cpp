// SPDX-License-Identifier: BSD-3-Clause
#include "query_generators.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

namespace fcl {
namespace test {
namespace {

using fcl::ContinuousContactKind;
using Vec = Vector3<double>;

/// An integer in [-half, half].
double integer(Random& random, int half) {
  return static_cast<double>(random.index(static_cast<std::size_t>(2 * half + 1))) - half;
}

Vec gridPoint(Random& random, int half) {
  const double x = integer(random, half), y = integer(random, half);
  return {x, y, integer(random, half)};
}

template <typename T, std::size_t n>
T oneOf(Random& random, const T (&list)[n]) {
  return list[random.index(n)];
}

void setPath(MovingPair& pair, std::size_t i, const Vec& t0, const Vec& t1) {
  for (int k = 0; k < 3; ++k) {
    pair.x[i].t0[k] = t0[k];
    pair.x[i].t1[k] = t1[k];
  }
}

/// How the touching point of one feature passes the other feature.
enum class Passage {
  kAcross,  // most often a simple root of the coplanarity cubic
  kTangent,
  kTriple,
  kResting  // stays on the same point
};

/// The form of the features when they touch.
enum class Shape {
  kProper,
  kFlat,      // a triangle without area, parallel edges; always
  kFlatOnce,  // only at the time of touching
  kPoint      // a triangle with two or three equal corners, an edge without length
};

struct TouchOptions {
  Passage passage{Passage::kAcross};
  Shape shape{Shape::kProper};
  bool at_border{false};
  /// The features touch at time numerator / denominator.
  int numerator{0};
  int denominator{1};
};

/// A time strictly between the frames. Often it is not a double.
void setInnerTime(Random& random, TouchOptions& options) {
  constexpr int kDenominators[] = {2, 3, 4, 5, 7, 8};
  options.denominator = oneOf(random, kDenominators);
  options.numerator =
      1 +
      static_cast<int>(random.index(static_cast<std::size_t>(options.denominator) - 1));
}

/// Makes b, the second of two directions, or both directions degenerate, together with
/// their velocities.
void flatten(Random& random, Shape shape, Vec& a, Vec& b, Vec& a_velocity,
             Vec& b_velocity) {
  if (shape == Shape::kProper) return;
  constexpr double kFactors[] = {-2, -1, -0.5, 0.5, 1, 2};
  const double factor = shape == Shape::kPoint ? 0 : oneOf(random, kFactors);
  b = factor * a;
  if (shape != Shape::kFlatOnce) b_velocity = factor * a_velocity;
  if (shape == Shape::kPoint && random.index(2)) a = a_velocity = Vec::Zero();
}

/// Features that touch by construction. All coordinates are small multiples of 1/4, so
/// that nothing is rounded.
///
/// Let p be a point of fixed weights on each feature and r the velocity of one relative
/// to the other. The volume of the four points is s r.n(s), where s is the time since the
/// touch and n(s) = n0 + s n1 + s^2 n2 the cross product of the two directions. Its root
/// at s = 0 is double if r.n0 = 0, and triple if r.n1 = 0 as well.
MovingPair touchingPair(Random& random, const TouchOptions& options) {
  MovingPair pair{randomKind(random), {}};
  const bool vf = pair.kind == ContinuousContactKind::kVertexFace;
  // Directions from f0 (VF) or along the edges (EE), and how they change.
  Vec a = gridPoint(random, 4), b = gridPoint(random, 4);
  Vec a_velocity = gridPoint(random, 2), b_velocity = gridPoint(random, 2);
  flatten(random, options.shape, a, b, a_velocity, b_velocity);

  const Vec n0 = a.cross(b), n1 = a.cross(b_velocity) + a_velocity.cross(b);
  Vec relative = gridPoint(random, 3);
  if (options.passage == Passage::kTangent) {
    relative = integer(random, 2) * a;
    relative += integer(random, 2) * b;
  }
  if (options.passage == Passage::kTriple) relative = n0.cross(n1);
  if (options.passage == Passage::kResting) relative.setZero();

  constexpr double kWeights[] = {0.25, 0.5, 0.75};
  double r = oneOf(random, kWeights), s = oneOf(random, kWeights);
  if (vf) {
    s = std::min(s, 1 - r);
    if (r + s == 1 && !options.at_border) r = s = 0.25;
  }
  if (options.at_border) {
    const std::size_t side = random.index(3);
    if (side != 1) r = static_cast<double>(random.index(2));
    if (side != 0)
      s = vf ? (1 - r) * static_cast<double>(random.index(2))
             : static_cast<double>(random.index(2));
    if (vf) s = std::min(s, 1 - r);
  }

  Vec p[4], velocity[4];
  const Vec base = gridPoint(random, 4), base_velocity = gridPoint(random, 3);
  if (vf) {
    p[1] = base;
    velocity[1] = base_velocity;
    p[2] = base + a;
    velocity[2] = base_velocity + a_velocity;
    p[3] = base + b;
    velocity[3] = base_velocity + b_velocity;
    p[0] = base + r * a + s * b;
    velocity[0] = base_velocity + r * a_velocity + s * b_velocity + relative;
  } else {
    p[0] = base - r * a;
    velocity[0] = base_velocity - r * a_velocity;
    p[1] = p[0] + a;
    velocity[1] = velocity[0] + a_velocity;
    p[2] = base - s * b;
    velocity[2] = base_velocity + relative - s * b_velocity;
    p[3] = p[2] + b;
    velocity[3] = velocity[2] + b_velocity;
  }
  const double k = options.numerator, n = options.denominator;
  for (std::size_t i = 0; i < 4; ++i)
    setPath(pair, i, n * p[i] - k * velocity[i], n * p[i] + (n - k) * velocity[i]);
  return pair;
}

MovingPair uniform(Random& random) {
  MovingPair pair{randomKind(random), {}};
  for (std::size_t i = 0; i < 4; ++i) {
    const Vec t0 = random.point(1);
    setPath(pair, i, t0, random.point(1));
  }
  return pair;
}

/// Queries like those of two neighbouring triangles of a scene: small features, smaller
/// steps, floats.
MovingPair sceneLike(Random& random) {
  const double size = 0.02;
  const MovingPair near = nearContactPair(random, random.uniform(0, 0.5));
  const Vec place = random.point(1);
  MovingPair pair = near;
  for (auto& p : pair.x)
    for (int k = 0; k < 3; ++k) {
      // volatile: the compiler must not remove the rounding to float.
      const volatile float t0 = static_cast<float>(place[k] + size * p.t0[k]);
      const volatile float t1 = static_cast<float>(place[k] + size * p.t1[k]);
      p.t0[k] = t0;
      p.t1[k] = t1;
    }
  return pair;
}

/// Differences of coordinates lose digits.
MovingPair farFromOrigin(Random& random) {
  const double distance = std::ldexp(1, 10 + static_cast<int>(random.index(45)));
  const Vec place = random.point(distance);
  MovingPair pair = randomPair(random);
  for (auto& p : pair.x)
    for (int k = 0; k < 3; ++k) {
      p.t0[k] += place[k];
      p.t1[k] += place[k];
    }
  return pair;
}

MovingPair grid(Random& random) {
  return gridPair(random, 1 + static_cast<int>(random.index(3)));
}

/// Two axes and an origin: a plane through points of the grid.
struct GridPlane {
  Vec origin, u, v;

  explicit GridPlane(Random& random)
      : origin(gridPoint(random, 2)), u(gridPoint(random, 2)), v(gridPoint(random, 2)) {}
  Vec point(Random& random) const {
    const double i = integer(random, 3);
    return origin + i * u + integer(random, 3) * v;
  }
};

/// Features that are coplanar in one frame, or in each frame in a plane of its own.
MovingPair sharedPlane(Random& random) {
  MovingPair pair{randomKind(random), {}};
  const GridPlane start(random), end(random);
  const std::size_t which = random.index(3);
  for (std::size_t i = 0; i < 4; ++i) {
    const Vec t0 = which == 1 ? gridPoint(random, 3) : start.point(random);
    setPath(pair, i, t0, which == 0 ? gridPoint(random, 3) : end.point(random));
  }
  return pair;
}

/// All points in one plane, which may move as a whole: the coplanarity cubic vanishes.
MovingPair inPlaneMotion(Random& random) {
  MovingPair pair{randomKind(random), {}};
  const GridPlane plane(random);
  const Vec shift = random.index(2) ? Vec(gridPoint(random, 3)) : Vec(Vec::Zero());
  for (std::size_t i = 0; i < 4; ++i) {
    const Vec t0 = plane.point(random);
    setPath(pair, i, t0, plane.point(random) + shift);
  }
  return pair;
}

MovingPair touchAtStart(Random& random) {
  TouchOptions options;
  options.at_border = random.index(2) == 0;
  return touchingPair(random, options);
}

MovingPair touchAtEnd(Random& random) {
  TouchOptions options;
  options.numerator = 1;
  options.at_border = random.index(2) == 0;
  return touchingPair(random, options);
}

MovingPair touchBetween(Random& random) {
  TouchOptions options;
  setInnerTime(random, options);
  return touchingPair(random, options);
}

MovingPair touchAtBorder(Random& random) {
  TouchOptions options;
  setInnerTime(random, options);
  options.at_border = true;
  return touchingPair(random, options);
}

/// Any time from the first frame to the last.
TouchOptions anyTouch(Random& random) {
  TouchOptions options;
  setInnerTime(random, options);
  if (random.index(4) == 0) options.numerator = random.index(2) ? 0 : options.denominator;
  options.at_border = random.index(2) == 0;
  return options;
}

MovingPair tangent(Random& random) {
  TouchOptions options = anyTouch(random);
  options.passage = Passage::kTangent;
  return touchingPair(random, options);
}

MovingPair tripleRoot(Random& random) {
  TouchOptions options = anyTouch(random);
  options.passage = Passage::kTriple;
  return touchingPair(random, options);
}

MovingPair resting(Random& random) {
  TouchOptions options = anyTouch(random);
  options.passage = Passage::kResting;
  return touchingPair(random, options);
}

/// The two ranges of points that make up the features: [0, split) and [split, 4).
std::size_t splitOf(const MovingPair& pair) {
  return pair.kind == ContinuousContactKind::kVertexFace ? 1 : 2;
}

/// One or both features do not move, or move without a change of shape.
MovingPair still(Random& random) {
  MovingPair pair = random.index(2) ? grid(random) : touchAtStart(random);
  const std::size_t which = random.index(4), split = splitOf(pair);
  for (std::size_t i = 0; i < 4; ++i) {
    auto& p = pair.x[i];
    const auto& lead = pair.x[i < split ? 0 : split];
    for (int k = 0; k < 3; ++k) {
      if (which == 0 || (which == 1 && i < split) || (which == 2 && i >= split))
        p.t1[k] = p.t0[k];
      else if (i != 0 && i != split)
        p.t1[k] = p.t0[k] + (lead.t1[k] - lead.t0[k]);
    }
  }
  return pair;
}

MovingPair flatFeatures(Random& random) {
  TouchOptions options = anyTouch(random);
  options.shape = random.index(2) ? Shape::kFlat : Shape::kFlatOnce;
  return touchingPair(random, options);
}

MovingPair pointFeatures(Random& random) {
  TouchOptions options = anyTouch(random);
  options.shape = Shape::kPoint;
  return touchingPair(random, options);
}

/// Degenerate features that may or may not meet: parallel edges, zero area, equal points,
/// each in one frame or in both.
MovingPair flatGrid(Random& random) {
  MovingPair pair = gridPair(random, 2);
  const bool vf = pair.kind == ContinuousContactKind::kVertexFace;
  const std::size_t frames = 1 + random.index(3);
  constexpr double kFactors[] = {-1, 0, 0.5, 1, 2};
  const double factor = oneOf(random, kFactors);
  for (const std::size_t frame : {1, 2}) {
    if (!(frames & frame)) continue;
    const auto at = [&](std::size_t i) -> double(&)[3] {
      return frame == 1 ? pair.x[i].t0 : pair.x[i].t1;
    };
    for (int k = 0; k < 3; ++k) {
      if (vf)
        at(3)[k] = at(1)[k] + factor * (at(2)[k] - at(1)[k]);
      else
        at(3)[k] = at(2)[k] + factor * (at(1)[k] - at(0)[k]);
    }
  }
  return pair;
}

/// All points on one line, which may move as a whole.
MovingPair onOneLine(Random& random) {
  MovingPair pair{randomKind(random), {}};
  const Vec origin = gridPoint(random, 2), direction = gridPoint(random, 2);
  const Vec turned = random.index(2) ? direction : Vec(gridPoint(random, 2));
  const Vec shift = random.index(2) ? Vec(gridPoint(random, 2)) : Vec(Vec::Zero());
  for (std::size_t i = 0; i < 4; ++i) {
    const Vec t0 = origin + integer(random, 4) * direction;
    setPath(pair, i, t0, origin + shift + integer(random, 4) * turned);
  }
  return pair;
}

/// Points of the two features that are the same in one frame or in both.
MovingPair coincidentPoints(Random& random) {
  MovingPair pair = random.index(2) ? grid(random) : uniform(random);
  const std::size_t split = splitOf(pair), frames = 1 + random.index(3);
  for (std::size_t i = 0; i < split; ++i) {
    const auto& other = pair.x[split + random.index(4 - split)];
    if (frames & 1) std::copy(other.t0, other.t0 + 3, pair.x[i].t0);
    if (frames & 2) std::copy(other.t1, other.t1 + 3, pair.x[i].t1);
  }
  return pair;
}

/// One of the families above that touch or are flat.
MovingPair anyDegenerate(Random& random) {
  constexpr MovingPair (*kAll[])(Random&) = {
      grid,          sharedPlane,  inPlaneMotion, touchAtStart,
      touchAtEnd,    touchBetween, touchAtBorder, tangent,
      tripleRoot,    resting,      still,         flatFeatures,
      pointFeatures, flatGrid,     onOneLine,     coincidentPoints};
  return oneOf(random, kAll)(random);
}

/// The query with axes exchanged and mirrored, points renamed within their features, and
/// coordinates times a power of two.
MovingPair permutedAndScaled(Random& random) {
  MovingPair pair = anyDegenerate(random);
  const std::size_t split = splitOf(pair);
  for (std::size_t i = 3; i > split; --i)
    std::swap(pair.x[i], pair.x[split + random.index(i - split + 1)]);
  if (split == 2) {
    if (random.index(2)) std::swap(pair.x[0], pair.x[1]);
    if (random.index(2)) {
      std::swap(pair.x[0], pair.x[2]);
      std::swap(pair.x[1], pair.x[3]);
    }
  }
  std::size_t axis[3] = {0, 1, 2};
  for (std::size_t k = 2; k > 0; --k) std::swap(axis[k], axis[random.index(k + 1)]);
  const double scale = std::ldexp(1, static_cast<int>(random.index(161)) - 80);
  const double factor[3] = {random.index(2) ? scale : -scale,
                            random.index(2) ? scale : -scale, scale};
  MovingPair out = pair;
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t k = 0; k < 3; ++k) {
      out.x[i].t0[k] = factor[k] * pair.x[i].t0[axis[k]];
      out.x[i].t1[k] = factor[k] * pair.x[i].t1[axis[k]];
    }
  return out;
}

/// A degenerate query with some coordinates at the next double.
MovingPair oneUlpAway(Random& random) {
  MovingPair pair = anyDegenerate(random);
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (std::size_t count = 1 + random.index(3); count > 0; --count) {
    auto& p = pair.x[random.index(4)];
    double& c = (random.index(2) ? p.t0 : p.t1)[random.index(3)];
    // The neighbours of 0 are subnormal, and all other coordinates are huge compared with
    // them. So 0 moves by the ulp of 1.
    if (c == 0)
      c = random.index(2) ? 0x1p-52 : -0x1p-52;
    else
      c = std::nextafter(c, random.index(2) ? kInfinity : -kInfinity);
  }
  return pair;
}

/// A degenerate query turned about the origin, rounded.
MovingPair rotated(Random& random) {
  MovingPair pair = anyDegenerate(random);
  Vec axis[3];
  do axis[0] = random.point(1);
  while (axis[0].squaredNorm() < 0.1);
  do axis[1] = axis[0].cross(random.point(1));
  while (axis[1].squaredNorm() < 0.01);
  axis[0] /= std::sqrt(axis[0].dot(axis[0]));
  axis[1] /= std::sqrt(axis[1].dot(axis[1]));
  axis[2] = axis[0].cross(axis[1]);
  for (auto& p : pair.x)
    for (double(*frame)[3] : {&p.t0, &p.t1}) {
      const Vec old((*frame)[0], (*frame)[1], (*frame)[2]);
      for (int k = 0; k < 3; ++k)
        (*frame)[k] = axis[0][k] * old[0] + axis[1][k] * old[1] + axis[2][k] * old[2];
    }
  return pair;
}

/// A degenerate query at the ends of the range of doubles: as a whole, or each point or
/// frame with a scale of its own.
MovingPair extremeExponents(Random& random) {
  MovingPair pair = anyDegenerate(random);
  double largest = 1;
  for (const auto& p : pair.x)
    for (int k = 0; k < 3; ++k)
      largest = std::max({largest, std::abs(p.t0[k]), std::abs(p.t1[k])});
  const int top = 1022 - std::ilogb(largest);
  const int exponents[] = {-1074, -1070, -1022, -600, -340, -60, 0, 60, 300, 600, top};
  const int all = oneOf(random, exponents);
  const std::size_t mixed = random.index(4);
  const int frame[2] = {all, mixed == 2 ? oneOf(random, exponents) : all};
  for (auto& p : pair.x) {
    const int extra = mixed == 1 && random.index(2) ? oneOf(random, exponents) : 0;
    for (int k = 0; k < 3; ++k) {
      p.t0[k] = std::ldexp(p.t0[k], extra ? extra : frame[0]);
      p.t1[k] = std::ldexp(p.t1[k], extra ? extra : frame[1]);
    }
  }
  return pair;
}

}  // namespace

const std::vector<QueryFamily>& queryFamilies() {
  static const std::vector<QueryFamily> families = {
      {"uniform", false, uniform},
      {"scene-like", false, sceneLike},
      {"near-contact", false, randomPair},
      {"far-from-origin", false, farFromOrigin},
      {"grid", true, grid},
      {"shared-plane", true, sharedPlane},
      {"in-plane-motion", true, inPlaneMotion},
      {"touch-at-start", true, touchAtStart},
      {"touch-at-end", true, touchAtEnd},
      {"touch-between", true, touchBetween},
      {"touch-at-border", true, touchAtBorder},
      {"tangent", true, tangent},
      {"triple-root", true, tripleRoot},
      {"resting", true, resting},
      {"still", true, still},
      {"flat-features", true, flatFeatures},
      {"point-features", true, pointFeatures},
      {"flat-grid", true, flatGrid},
      {"on-one-line", true, onOneLine},
      {"coincident-points", true, coincidentPoints},
      {"permuted-and-scaled", true, permutedAndScaled},
      {"one-ulp-away", true, oneUlpAway},
      {"rotated", true, rotated},
      {"extreme-exponents", true, extremeExponents},
  };
  return families;
}

const QueryFamily& queryFamily(const std::string& name) {
  for (const QueryFamily& family : queryFamilies())
    if (family.name == name) return family;
  throw std::invalid_argument("no family of queries: " + name);
}

}  // namespace test
}  // namespace fcl

// SPDX-License-Identifier: BSD-3-Clause
#include "exact_oracle.h"

#include <CGAL/Algebraic_kernel_d_1.h>
#include <CGAL/Gmpq.h>
#include <CGAL/Gmpz.h>

#include <algorithm>
#include <array>
#include <boost/multiprecision/gmp.hpp>
#include <climits>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <stdexcept>
#include <utility>
#include <vector>

namespace fcl {
namespace test {
namespace {

using detail::deformable::FeaturePoints;
using fcl::ContinuousContactKind;

using Integer = CGAL::Gmpz;
using Fraction = CGAL::Gmpq;
using Kernel = CGAL::Algebraic_kernel_d_1<Integer>;
using Polynomial = Kernel::Polynomial_1;
using Algebraic = Kernel::Algebraic_real_1;

int degreeOf(const Polynomial& p) { return CGAL::is_zero(p) ? -1 : p.degree(); }

Integer coefficient(const Polynomial& p, int i) {
  return i <= degreeOf(p) ? p[i] : Integer(0);
}

/// The sign of p on an interval if all its Bernstein coefficients there have it, else 0.
int commonSign(const Polynomial& p, const Fraction& lo, const Fraction& hi) {
  const int degree = degreeOf(p);
  // The coefficients by repeated evaluation in two arguments (blossoming).
  int sign = 0;
  for (int j = 0; j <= degree; ++j) {
    // Coefficient j: the mean of the products of i of the arguments, j times hi, the rest
    // lo, is e_i / (degree choose i), with e_i the elementary symmetric function.
    std::vector<Fraction> e(static_cast<std::size_t>(degree) + 1, Fraction(0));
    e[0] = Fraction(1);
    for (int k = 0; k < degree; ++k)
      for (int i = k + 1; i > 0; --i)
        e[static_cast<std::size_t>(i)] +=
            e[static_cast<std::size_t>(i) - 1] * (k < j ? hi : lo);
    Fraction value(0), choose(1);
    for (int i = 0; i <= degree; ++i) {
      value += Fraction(p[i]) * e[static_cast<std::size_t>(i)] / choose;
      choose = choose * Fraction(degree - i) / Fraction(i + 1);
    }
    const int now = static_cast<int>(CGAL::sign(value));
    if (now == 0 || (sign != 0 && now != sign)) return 0;
    sign = now;
  }
  return sign;
}

/// Sign at a time. Without a verdict from the isolating interval the kernel takes a
/// greatest common divisor, which is slow.
int signAt(const Polynomial& p, const Algebraic& t) {
  constexpr int kRounds = 6, kHalvings = 8;
  const int degree = degreeOf(p);
  if (degree <= 0) return degree < 0 ? 0 : static_cast<int>(CGAL::sign(p[0]));
  for (int round = 0; round < kRounds; ++round) {
    if (t.is_rational()) break;
    const int sign = commonSign(p, t.low(), t.high());
    if (sign != 0) return sign;
    for (int i = 0; i < kHalvings; ++i) t.bisect();
  }
  if (t.is_rational()) return static_cast<int>(p.sign_at(t.rational()));
  return static_cast<int>(Kernel().sign_at_1_object()(p, t));
}

/// A double as digits times 2^exponent, digits odd or 0.
struct BinaryNumber {
  std::int64_t digits{0};
  int exponent{INT_MAX};

  explicit BinaryNumber(double value) {
    if (value == 0) return;
    digits = static_cast<std::int64_t>(std::ldexp(std::frexp(value, &exponent), 53));
    exponent -= 53;
    while (digits % 2 == 0) {
      digits /= 2;
      ++exponent;
    }
  }
  Integer inUnitsOf(int unit_exponent) const {
    Integer out(static_cast<double>(digits));
    if (digits != 0)
      mpz_mul_2exp(out.mpz(), out.mpz(),
                   static_cast<mp_bitcnt_t>(exponent - unit_exponent));
    return out;
  }
};

/// The four points with coordinates that are polynomials in t of degree 1.
class MovingPoints {
 public:
  explicit MovingPoints(const FeaturePoints& x) {
    int unit = INT_MAX;
    for (int i = 0; i < 4; ++i)
      for (int k = 0; k < 3; ++k)
        unit = std::min(
            {unit, BinaryNumber(x[i].t0[k]).exponent, BinaryNumber(x[i].t1[k]).exponent});
    for (int i = 0; i < 4; ++i)
      for (int k = 0; k < 3; ++k) {
        const Integer from = BinaryNumber(x[i].t0[k]).inUnitsOf(unit);
        const Integer to = BinaryNumber(x[i].t1[k]).inUnitsOf(unit);
        at(i, k) = Polynomial(from, Integer(to - from));
      }
  }

  Polynomial difference(int i, int j, int k) const { return at(i, k) - at(j, k); }

  /// Twice the oriented area of points i, j, l with coordinate k left out.
  Polynomial turn(int i, int j, int l, int k) const {
    const int m = (k + 1) % 3, n = (k + 2) % 3;
    return difference(j, i, m) * difference(l, i, n) -
           difference(j, i, n) * difference(l, i, m);
  }

  /// Six times the oriented volume of all four.
  Polynomial volume() const {
    Polynomial sum(Integer(0));
    for (int k = 0; k < 3; ++k) sum = sum + difference(0, 1, k) * turn(1, 2, 3, k);
    return sum;
  }

 private:
  const Polynomial& at(int i, int k) const {
    return coordinates_[static_cast<std::size_t>(3 * i + k)];
  }
  Polynomial& at(int i, int k) {
    return coordinates_[static_cast<std::size_t>(3 * i + k)];
  }
  std::array<Polynomial, 12> coordinates_;
};

/// Three points i, j, l, of which l is judged by its side of the line ij.
struct Triple {
  int i, j, l;
};

/// A point against the end points of a segment.
struct PointAndSegment {
  int point, begin, end;
};

/// What decides whether coplanar features touch: orientations in coordinate planes, and
/// for borders the order of coordinates.
class Conditions {
 public:
  Conditions(ContinuousContactKind kind, const FeaturePoints& x)
      : kind_(kind), points_(x) {
    if (kind == ContinuousContactKind::kVertexFace) {
      turns_ = {{1, 2, 0}, {2, 3, 0}, {3, 1, 0}};
      borders_ = {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}};
    } else {
      turns_ = {{0, 1, 2}, {0, 1, 3}, {2, 3, 0}, {2, 3, 1}};
      borders_ = {{2, 0, 1}, {3, 0, 1}, {0, 2, 3}, {1, 2, 3}};
    }
  }

  Polynomial volume() const { return points_.volume(); }

  /// Whether the features touch at t, a time at which the four points are coplanar.
  bool touchAt(const Algebraic& t) const {
    // zero[b]: the point of border b lies on the border's line, seen along every axis.
    bool on_line[4] = {true, true, true, true};
    for (int k = 0; k < 3; ++k) {
      int side[4] = {};
      for (std::size_t i = 0; i < turns_.size(); ++i) {
        side[i] = signAt(points_.turn(turns_[i].i, turns_[i].j, turns_[i].l, k), t);
        if (side[i] != 0) on_line[i] = false;
      }
      if (kind_ == ContinuousContactKind::kVertexFace) {
        // Strictly on one side of all borders: inside a projection that has an area, so
        // that a coplanar vertex is inside. On different sides of two borders: outside
        // of the projection, even of one without area, whose three turns have sum 0.
        const bool left = side[0] > 0 || side[1] > 0 || side[2] > 0;
        const bool right = side[0] < 0 || side[1] < 0 || side[2] < 0;
        if (left && right) return false;
        if (side[0] * side[1] * side[2] != 0) return true;
      } else {
        // One edge strictly on one side of the other's line, in a projection: apart.
        // Each on both sides: the projections cross, and coplanar edges do as well.
        if (side[0] * side[1] > 0 || side[2] * side[3] > 0) return false;
        if (side[0] * side[1] < 0 && side[2] * side[3] < 0) return true;
      }
    }
    // What is left touches at a border, or is flat: a union of segments.
    for (std::size_t b = 0; b < borders_.size(); ++b)
      if (on_line[b] && isBetween(borders_[b], t)) return true;
    return false;
  }

  /// All conditions, whose signs make up touchAt(): between the roots of these nothing
  /// changes.
  std::vector<Polynomial> polynomials() const {
    std::vector<Polynomial> all;
    for (int k = 0; k < 3; ++k) {
      for (const Triple& s : turns_) all.push_back(points_.turn(s.i, s.j, s.l, k));
      for (const PointAndSegment& b : borders_) {
        all.push_back(points_.difference(b.point, b.begin, k));
        all.push_back(points_.difference(b.point, b.end, k));
      }
    }
    return all;
  }

 private:
  /// Whether a point on the line of a segment is on the segment.
  bool isBetween(const PointAndSegment& b, const Algebraic& t) const {
    for (int k = 0; k < 3; ++k)
      if (signAt(points_.difference(b.point, b.begin, k), t) *
              signAt(points_.difference(b.point, b.end, k), t) >
          0)
        return false;
    return true;
  }

  ContinuousContactKind kind_;
  MovingPoints points_;
  std::vector<Triple> turns_;
  /// In the order of turns_ : the border's turn is that of its point.
  std::vector<PointAndSegment> borders_;
};

/// Whether some axis separates the features strictly in both frames, hence always.
bool areSeparatedAlongAxis(ContinuousContactKind kind, const FeaturePoints& x) {
  const int split = kind == ContinuousContactKind::kVertexFace ? 1 : 2;
  for (int k = 0; k < 3; ++k) {
    bool below = true, above = true;
    for (int i = 0; i < split; ++i)
      for (int j = split; j < 4; ++j) {
        below = below && x[i].t0[k] < x[j].t0[k] && x[i].t1[k] < x[j].t1[k];
        above = above && x[i].t0[k] > x[j].t0[k] && x[i].t1[k] > x[j].t1[k];
      }
    if (below || above) return true;
  }
  return false;
}

/// Whether a cubic provably has no root in [0, 1]: its Bernstein coefficients, times 3,
/// have one sign.
bool hasNoRootInUnitInterval(const Polynomial& p) {
  const Integer c0 = coefficient(p, 0), c1 = coefficient(p, 1), c2 = coefficient(p, 2),
                c3 = coefficient(p, 3);
  const Integer b1 = c0 * 3 + c1, b2 = c0 * 3 + c1 * 2 + c2, b3 = c0 + c1 + c2 + c3;
  const CGAL::Sign sign = CGAL::sign(c0);
  return sign != CGAL::ZERO && sign == CGAL::sign(b1) && sign == CGAL::sign(b2) &&
         sign == CGAL::sign(b3);
}

/// The roots of p in (0, 1], ascending.
std::vector<Algebraic> rootsAfterStart(const Polynomial& p) {
  std::vector<std::pair<Algebraic, int>> roots;
  Kernel().solve_1_object()(p, std::back_inserter(roots));
  std::vector<Algebraic> inside;
  for (const auto& [root, multiplicity] : roots)
    if (root > Fraction(0) && root <= Fraction(1)) inside.push_back(root);
  return inside;
}

/// Times of which one is the first contact, if there is any after t = 0 and the points
/// are coplanar at all times.
std::vector<Algebraic> changesOf(const Conditions& conditions) {
  std::vector<Algebraic> times;
  for (const Polynomial& p : conditions.polynomials()) {
    if (degreeOf(p) < 1) continue;
    for (Algebraic& root : rootsAfterStart(p)) times.push_back(std::move(root));
  }
  std::sort(times.begin(), times.end());
  times.erase(std::unique(times.begin(), times.end()), times.end());
  return times;
}

/// A number strictly between s < t. (The kernel's own functor needs MPFI.)
Fraction between(const Algebraic& s, const Algebraic& t) {
  while (t.low() <= s.high()) {
    s.bisect();
    t.bisect();
  }
  return (s.high() + t.low()) / 2;
}

OracleAnswer::Rational toRational(const Fraction& value) {
  const boost::multiprecision::mpz_int numerator(value.numerator().mpz()),
      denominator(value.denominator().mpz());
  using BoostInteger = boost::multiprecision::cpp_int;
  return {static_cast<BoostInteger>(numerator), static_cast<BoostInteger>(denominator)};
}

/// A point as polynomials in t.
using MovingVector = std::array<Polynomial, 3>;

Polynomial dot(const MovingVector& a, const MovingVector& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

MovingVector cross(const MovingVector& a, const MovingVector& b) {
  return {Polynomial(a[1] * b[2] - a[2] * b[1]), Polynomial(a[2] * b[0] - a[0] * b[2]),
          Polynomial(a[0] * b[1] - a[1] * b[0])};
}

MovingVector operator-(const MovingVector& a, const MovingVector& b) {
  return {Polynomial(a[0] - b[0]), Polynomial(a[1] - b[1]), Polynomial(a[2] - b[2])};
}

/// Two vertices, a vertex and an edge, or the insides of two features. While all sides
/// are >= 0 and `extent` is not 0, points of the two are at a distance whose square less
/// d^2 has the sign of `excess`.
struct FeatureParts {
  Polynomial excess, extent;
  std::vector<Polynomial> sides;
};

/// What the distance of two features depends on: it is that of the nearest of the parts.
std::vector<FeatureParts> partsOf(ContinuousContactKind kind, const FeaturePoints& x,
                                  double d) {
  const int count = kind == ContinuousContactKind::kVertexVertex ? 2
                    : kind == ContinuousContactKind::kVertexEdge ? 3
                                                                 : 4;
  int unit = BinaryNumber(d).exponent;
  for (int i = 0; i < count; ++i)
    for (int k = 0; k < 3; ++k)
      unit = std::min(
          {unit, BinaryNumber(x[i].t0[k]).exponent, BinaryNumber(x[i].t1[k]).exponent});
  MovingVector p[4];
  for (int i = 0; i < count; ++i)
    for (std::size_t k = 0; k < 3; ++k) {
      const Integer from = BinaryNumber(x[i].t0[k]).inUnitsOf(unit);
      p[i][k] =
          Polynomial(from, Integer(BinaryNumber(x[i].t1[k]).inUnitsOf(unit) - from));
    }
  const Integer distance = BinaryNumber(d).inUnitsOf(unit);
  const Polynomial square(Integer(distance * distance));
  std::vector<FeatureParts> parts;
  const auto addPoints = [&](int i, int j) {
    const MovingVector way = p[j] - p[i];
    parts.push_back({Polynomial(dot(way, way) - square), Polynomial(Integer(1)), {}});
  };
  const auto addPointAndEdge = [&](int i, int j, int l) {
    const MovingVector edge = p[l] - p[j], from = p[i] - p[j], off = cross(from, edge);
    const Polynomial length = dot(edge, edge), along = dot(from, edge);
    parts.push_back({Polynomial(dot(off, off) - square * length),
                     length,
                     {along, Polynomial(length - along)}});
  };
  if (kind == ContinuousContactKind::kVertexVertex) {
    addPoints(0, 1);
  } else if (kind == ContinuousContactKind::kVertexEdge) {
    addPoints(0, 1);
    addPoints(0, 2);
    addPointAndEdge(0, 1, 2);
  } else {
    const bool vf = kind == ContinuousContactKind::kVertexFace;
    for (int i = 0; i < (vf ? 1 : 2); ++i)
      for (int j = vf ? 1 : 2; j < 4; ++j) addPoints(i, j);
    const MovingVector u = p[0] - p[vf ? 1 : 2], v = vf ? p[2] - p[1] : p[1] - p[0],
                       w = vf ? p[3] - p[1] : p[3] - p[2], n = cross(v, w);
    const Polynomial area = dot(n, n), volume = dot(u, n);
    FeatureParts inside{Polynomial(volume * volume - square * area), area, {}};
    if (vf) {
      addPointAndEdge(0, 1, 2);
      addPointAndEdge(0, 2, 3);
      addPointAndEdge(0, 3, 1);
      const Polynomial second = dot(cross(u, w), n), third = dot(cross(v, u), n);
      inside.sides = {second, third, Polynomial(area - second - third)};
    } else {
      addPointAndEdge(0, 2, 3);
      addPointAndEdge(1, 2, 3);
      addPointAndEdge(2, 0, 1);
      addPointAndEdge(3, 0, 1);
      // a0 + s v nearest to b0 + r w: s n^2 = (w x u) . n, r n^2 = (v x u) . n.
      const Polynomial s = dot(cross(w, u), n), r = dot(cross(v, u), n);
      inside.sides = {s, Polynomial(area - s), r, Polynomial(area - r)};
    }
    parts.push_back(inside);
  }
  return parts;
}

bool areSidesMet(const FeatureParts& part, const Algebraic& t) {
  return signAt(part.extent, t) != 0 &&
         std::all_of(part.sides.begin(), part.sides.end(),
                     [&t](const Polynomial& side) { return signAt(side, t) >= 0; });
}

bool isWithinAt(const std::vector<FeatureParts>& parts, const Algebraic& t) {
  return std::any_of(parts.begin(), parts.end(), [&t](const FeatureParts& part) {
    return signAt(part.excess, t) <= 0 && areSidesMet(part, t);
  });
}

/// Whether all Bernstein coefficients on [0, 1] are positive, or all negative.
bool hasOneSignInUnitInterval(const Polynomial& p) {
  const int degree = degreeOf(p);
  int sign = 0;
  for (int j = 0; j <= degree; ++j) {
    // Times (degree choose j): sum of p_i (degree - i choose j - i).
    Integer b(0);
    for (int i = 0; i <= j; ++i) {
      Integer choose(1);
      for (int k = 1; k <= j - i; ++k) choose = choose * (degree - i - (j - i) + k) / k;
      b += choose * coefficient(p, i);
    }
    const int now = static_cast<int>(CGAL::sign(b));
    if (now == 0 || (sign != 0 && now != sign)) return false;
    sign = now;
  }
  return true;
}

}  // namespace

struct OracleAnswer::FirstTime {
  Algebraic t;
};

int OracleAnswer::compareTime(double value) const {
  const Algebraic& t = time_->t;
  const Fraction at(value);
  if (t.is_rational()) return static_cast<int>(CGAL::compare(t.rational(), at));
  if (at <= t.low()) return 1;
  if (at >= t.high()) return -1;
  const int sign = static_cast<int>(t.polynomial().sign_at(at));
  return sign == 0 ? 0 : sign == static_cast<int>(t.sign_at_low()) ? 1 : -1;
}

bool OracleAnswer::isExact() const { return time_->t.is_rational(); }

OracleAnswer::Rational OracleAnswer::lower() const { return toRational(time_->t.low()); }

OracleAnswer::Rational OracleAnswer::upper() const { return toRational(time_->t.high()); }

void OracleAnswer::refine(const Rational& width) {
  while (!isExact() && upper() - lower() > width) time_->t.bisect();
}

OracleAnswer askOracle(ContinuousContactKind kind, const FeaturePoints& x) {
  if (areSeparatedAlongAxis(kind, x)) return {};
  const Conditions conditions(kind, x);
  const Polynomial volume = conditions.volume();
  const auto answer = [](const Algebraic& t) {
    return OracleAnswer(
        std::make_shared<OracleAnswer::FirstTime>(OracleAnswer::FirstTime{t}));
  };
  const Algebraic start(Fraction(0));
  if (signAt(volume, start) == 0 && conditions.touchAt(start)) return answer(start);

  if (!CGAL::is_zero(volume)) {
    if (hasNoRootInUnitInterval(volume)) return {};
    for (const Algebraic& t : rootsAfterStart(volume))
      if (conditions.touchAt(t)) return answer(t);
    return {};
  }
  // The times of contact are a closed set that changes only at roots of conditions, so
  // that its first time is one of them; a time before each is looked at all the same.
  Algebraic previous = start;
  std::vector<Algebraic> times = changesOf(conditions);
  const Algebraic end(Fraction(1));
  if (times.empty() || times.back() != end) times.push_back(end);
  for (const Algebraic& t : times) {
    if (conditions.touchAt(Algebraic(between(previous, t))))
      throw std::logic_error("oracle: a contact begins between two changes");
    if (conditions.touchAt(t)) return answer(t);
    previous = t;
  }
  return {};
}

bool isWithinAt(ContinuousContactKind kind, const FeaturePoints& x, double d, double t) {
  return isWithinAt(partsOf(kind, x, d), Algebraic(Fraction(t)));
}

OracleAnswer askDistanceOracle(ContinuousContactKind kind, const FeaturePoints& x,
                               double d) {
  const std::vector<FeatureParts> parts = partsOf(kind, x, d);
  const auto answer = [](const Algebraic& t) {
    return OracleAnswer(
        std::make_shared<OracleAnswer::FirstTime>(OracleAnswer::FirstTime{t}));
  };
  const Algebraic start(Fraction(0));
  if (isWithinAt(parts, start)) return answer(start);
  // Then the first time at which the distance is d is a root of the excess of the parts
  // that are nearest. Parts whose excess is always 0 begin or cease to be nearest where
  // others are just as near.
  std::vector<Algebraic> first;
  for (const FeatureParts& part : parts) {
    if (degreeOf(part.excess) < 1 || hasOneSignInUnitInterval(part.excess)) continue;
    for (const Algebraic& t : rootsAfterStart(part.excess)) {
      if (!first.empty() && !(t < first.front())) break;
      if (!areSidesMet(part, t)) continue;
      first.assign(1, t);
      break;
    }
  }
  return first.empty() ? OracleAnswer() : answer(first.front());
}

}  // namespace test
}  // namespace fcl

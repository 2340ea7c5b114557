// SPDX-License-Identifier: BSD-3-Clause
#include "fragile_designs.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

namespace fcl {
namespace test {
namespace {

using Vec = Vector3<double>;

/// Squares of a letter hang together along their sides, never at a corner alone.
struct BlockLetter {
  const char* rows[7];
};
const BlockLetter kLetters[] = {
    {{"#####", "#...#", "#...#", "#####", "#...#", "#...#", "#...#"}},  // A
    {{"#####", "#....", "#....", "#....", "#....", "#....", "#####"}},  // C
    {{"#####", "#....", "#....", "####.", "#....", "#....", "#####"}},  // E
    {{"#####", "#....", "#....", "####.", "#....", "#....", "#...."}},  // F
    {{"#...#", "#...#", "#...#", "#####", "#...#", "#...#", "#...#"}},  // H
    {{"#....", "#....", "#....", "#....", "#....", "#....", "#####"}},  // L
    {{"#####", "#...#", "#...#", "#####", "#....", "#....", "#...."}},  // P
    {{"#####", "#....", "#....", "#####", "....#", "....#", "#####"}},  // S
    {{"#####", "..#..", "..#..", "..#..", "..#..", "..#..", "..#.."}},  // T
    {{"#...#", "#...#", "#...#", "#...#", "#...#", "#...#", "#####"}},  // U
};

using Square = std::array<int, 2>;

/// Pieces grow from random squares, the smallest one first.
std::map<Square, int> growPieces(const std::vector<Square>& squares, int pieces,
                                 Random& random) {
  std::map<Square, int> piece_of;
  for (const Square& s : squares) piece_of[s] = -1;
  std::vector<std::vector<Square>> members;
  while (static_cast<int>(members.size()) < pieces) {
    const Square& seed = squares[random.index(squares.size())];
    if (piece_of[seed] >= 0) continue;
    piece_of[seed] = static_cast<int>(members.size());
    members.push_back({seed});
  }
  std::vector<char> is_closed(members.size(), 0);
  for (std::size_t grown = members.size(); grown < squares.size();) {
    std::size_t piece = members.size();
    for (std::size_t p = 0; p < members.size(); ++p)
      if (!is_closed[p] &&
          (piece == members.size() || members[p].size() < members[piece].size()))
        piece = p;
    bool has_grown = false;
    for (std::size_t i = 0; i < members[piece].size() && !has_grown; ++i)
      for (const Square& step : {Square{{1, 0}}, {{-1, 0}}, {{0, 1}}, {{0, -1}}}) {
        const Square next{
            {members[piece][i][0] + step[0], members[piece][i][1] + step[1]}};
        const auto found = piece_of.find(next);
        if (found == piece_of.end() || found->second >= 0) continue;
        found->second = static_cast<int>(piece);
        members[piece].push_back(next);
        has_grown = true;
        ++grown;
        break;
      }
    is_closed[piece] = !has_grown;
  }
  return piece_of;
}

double ellipsoid(const Vec& p, const Vec& centre, const Vec& radii) {
  // A bound of the distance, exact to first order at the surface.
  const Vec q = (p - centre).cwiseQuotient(radii);
  const double length = q.norm();
  const double slope = q.cwiseQuotient(radii).norm();
  return slope > 0 ? length * (length - 1) / slope : -radii.minCoeff();
}

double smoothMin(double a, double b, double width) {
  const double h = std::max(0.0, width - std::abs(a - b)) / width;
  return std::min(a, b) - 0.25 * h * h * width;
}

/// Negative inside the lion, about the distance outside. All of it is seen from
/// kLionCentre.
const Vec kLionCentre(0, 0, 0.42);
double lion(const Vec& point) {
  const Vec p(std::abs(point[0]), point[1], point[2]);
  double d = ellipsoid(p, {0, 0.06, 0.40}, {0.20, 0.26, 0.33});                // trunk
  d = smoothMin(d, ellipsoid(p, {0, -0.10, 0.52}, {0.19, 0.17, 0.24}), 0.06);  // chest
  d = smoothMin(d, ellipsoid(p, {0, -0.13, 0.78}, {0.20, 0.19, 0.20}), 0.06);  // mane
  d = smoothMin(d, ellipsoid(p, {0, -0.27, 0.76}, {0.12, 0.12, 0.11}), 0.03);  // face
  d = smoothMin(d, ellipsoid(p, {0, -0.36, 0.73}, {0.07, 0.07, 0.05}), 0.02);  // muzzle
  d = smoothMin(d, ellipsoid(p, {0.12, -0.12, 0.95}, {0.05, 0.04, 0.06}), 0.03);  // ears
  d = smoothMin(d, ellipsoid(p, {0.13, -0.22, 0.28}, {0.08, 0.09, 0.28}), 0.04);  // legs
  d = smoothMin(d, ellipsoid(p, {0.13, -0.30, 0.10}, {0.08, 0.10, 0.06}), 0.03);  // paws
  d = smoothMin(d, ellipsoid(p, {0.19, 0.16, 0.24}, {0.11, 0.20, 0.19}),
                0.04);                                                        // haunches
  d = smoothMin(d, ellipsoid(p, {0, 0.34, 0.36}, {0.05, 0.07, 0.22}), 0.04);  // tail
  // Curls of the mane, on the back of head and neck; hollows for the eyes.
  const double mane = std::exp(-(p - Vec(0, -0.08, 0.76)).squaredNorm() / 0.05) *
                      std::min(1.0, std::max(0.0, (p[1] + 0.24) / 0.06));
  d -= 0.012 * mane * std::sin(70 * p[0]) * std::sin(70 * p[2]) * std::cos(60 * p[1]);
  d += 0.012 * std::exp(-(p - Vec(0.05, -0.37, 0.80)).squaredNorm() / 0.0006);
  // Plinth.
  const Vec outside = (p - Vec(0, 0, 0.05)).cwiseAbs() - Vec(0.33, 0.42, 0.05);
  const double plinth = outside.cwiseMax(0).norm() + std::min(0.0, outside.maxCoeff());
  return smoothMin(d, plinth, 0.02);
}

/// The outermost point of the lion on a ray from its centre: walks inwards by three
/// quarters of the distance, which smooth unions and curls overrate a little.
Vec lionPoint(const Vec& direction) {
  double r = 0.75;
  for (int i = 0; i < 120; ++i) {
    const double d = lion(kLionCentre + r * direction);
    if (d < 1e-6) break;
    r -= 0.75 * d;
  }
  return kLionCentre + r * direction;
}

}  // namespace

int numLetters() { return static_cast<int>(std::size(kLetters)); }

ShellDesign makeLetter(int letter, double square, int divisions, int pieces,
                       Random& random) {
  const BlockLetter& block = kLetters[letter % numLetters()];
  std::vector<Square> squares;
  for (int y = 0; y < 7; ++y)
    for (int x = 0; x < 5; ++x)
      if (block.rows[6 - y][x] == '#') squares.push_back({{x, y}});
  const auto piece_of = growPieces(squares, pieces, random);
  ShellDesign design;
  std::map<Square, std::size_t> id_of;
  const double depth = 0.6 * square;
  const auto vertex = [&](int x, int y) {
    const auto inserted = id_of.emplace(Square{{x, y}}, design.outer.size());
    if (inserted.second) {
      const Vec p(square * (static_cast<double>(x) / divisions - 2.5), 0,
                  square * (static_cast<double>(y) / divisions - 3.5));
      design.outer.push_back(p - Vec(0, depth, 0));
      design.inner.push_back(p + Vec(0, depth, 0));
    }
    return inserted.first->second;
  };
  for (const Square& s : squares)
    for (int j = 0; j < divisions; ++j)
      for (int i = 0; i < divisions; ++i) {
        const int x = s[0] * divisions + i, y = s[1] * divisions + j;
        const std::size_t a = vertex(x, y), b = vertex(x + 1, y);
        const std::size_t c = vertex(x + 1, y + 1), d = vertex(x, y + 1);
        if ((x + y) % 2 == 0) {
          design.sheet.emplace_back(a, b, c);
          design.sheet.emplace_back(a, c, d);
        } else {
          design.sheet.emplace_back(a, b, d);
          design.sheet.emplace_back(b, c, d);
        }
        design.piece_of.insert(design.piece_of.end(), 2, piece_of.at(s));
      }
  return design;
}

ShellDesign makeLion(int frequency, int pieces, Random& random) {
  const TestMesh sphere = makeGeodesicSphere(frequency, 1);
  ShellDesign design;
  design.sheet = sphere.triangles;
  for (const Vec& direction : sphere.vertices) {
    const Vec p = lionPoint(direction);
    design.outer.push_back(p);
    design.inner.push_back(kLionCentre + 0.55 * (p - kLionCentre));
  }
  std::vector<Vec> seeds;
  for (int i = 0; i < pieces; ++i)
    seeds.push_back(design.outer[random.index(design.outer.size())] + random.point(0.02));
  for (const Triangle& t : design.sheet) {
    const Vec middle = (design.outer[t[0]] + design.outer[t[1]] + design.outer[t[2]]) / 3;
    int best = 0;
    double closest = std::numeric_limits<double>::max();
    for (int i = 0; i < pieces; ++i) {
      const double distance = (seeds[static_cast<std::size_t>(i)] - middle).squaredNorm();
      if (distance >= closest) continue;
      closest = distance;
      best = i;
    }
    design.piece_of.push_back(best);
  }
  // Seeds without a triangle have no piece.
  std::map<int, int> id_of;
  for (int& piece : design.piece_of)
    piece = id_of.emplace(piece, static_cast<int>(id_of.size())).first->second;
  return design;
}

}  // namespace test
}  // namespace fcl

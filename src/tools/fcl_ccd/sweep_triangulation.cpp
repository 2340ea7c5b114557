// SPDX-License-Identifier: BSD-3-Clause
#include "sweep_triangulation.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cstddef>
#include <deque>
#include <set>

#include "delaunay_flips.h"
#include "polygon_rings.h"

namespace fcl_ccd {
namespace {

/// @brief A part of the polygon that the sweep line crosses, between two edges.
struct Strip {
  // Edges by the corners at which they begin. The polygon lies to the left of each, so
  // that the lower one goes to the right, and the upper one to the left.
  int lower{-1}, upper{-1};
  // The chain: from the left end of the lower edge to that of the upper edge. Between its
  // ends it only turns to the left, away from the inside.
  int lo{-1}, hi{-1};
  int last{-1};  ///< the link that was added last: the sweep line can see it
  std::size_t number{0};
};

class Sweep {
 public:
  Sweep(const PolygonRings& rings, std::vector<PolygonTriangle>& out)
      : rings_(rings), out_(out), strips_(IsBelow{this}), owner_(rings.size(), nullptr) {}

  /// @return false if the polygon crosses itself, as far as this was noticed.
  bool run() {
    for (const int corner : events())
      if (!pass(corner)) return false;
    return strips_.empty();
  }

 private:
  struct Link {
    int corner;
    int before, after;  ///< towards lo and hi; -1 at the end
  };

  /// @brief The order of the strips, upwards. Strips do not overlap, so that only a
  /// corner has to be compared with strips: the one at which the new strip begins.
  struct IsBelow {
    using is_transparent = void;
    const Sweep* sweep;
    bool operator()(const Strip* strip, int corner) const {
      return sweep->sideOf(strip->upper, corner) > 0;
    }
    bool operator()(int corner, const Strip* strip) const {
      return sweep->sideOf(strip->lower, corner) < 0;
    }
    bool operator()(const Strip* a, const Strip* b) const {
      return a == sweep->new_strip_ ? (*this)(sweep->new_corner_, b)
                                    : (*this)(a, sweep->new_corner_);
    }
  };
  using Strips = std::set<Strip*, IsBelow>;

  bool isLeftward(int from, int to) const { return rings_.isBefore(to, from); }
  int next(int corner) const { return rings_.next(corner); }
  int before(int corner) const { return rings_.before(corner); }
  int turn(int a, int b, int c) const { return rings_.turn(a, b, c); }

  bool beginsHere(int corner) const {
    return !isLeftward(corner, before(corner)) && !isLeftward(corner, next(corner));
  }

  /// The corners from left to right. Of those at one place the ones with an edge to the
  /// left come first: their edges end or go on. Then come the others, outer wedges before
  /// the wedges inside of them.
  std::vector<int> events() const {
    std::vector<int> corners = rings_.corners();
    std::sort(corners.begin(), corners.end(), [this](int a, int b) {
      if (rings_.isBefore(a, b)) return true;
      if (rings_.isBefore(b, a)) return false;
      const bool a_begins = beginsHere(a), b_begins = beginsHere(b);
      if (a_begins != b_begins) return b_begins;
      if (a_begins) {
        const std::array<int, 2> wedge_a = wedge(a), wedge_b = wedge(b);
        if (const int low = turn(a, wedge_a[0], wedge_b[0])) return low > 0;
        if (const int high = turn(a, wedge_a[1], wedge_b[1])) return high < 0;
      }
      return a < b;
    });
    return corners;
  }

  /// The ends of the two edges of a corner to the right of it, the lower one first.
  std::array<int, 2> wedge(int corner) const {
    const int a = before(corner), b = next(corner);
    return turn(corner, a, b) > 0 ? std::array<int, 2>{a, b} : std::array<int, 2>{b, a};
  }

  /// On which side of an edge a corner is: 1 above, -1 below. A corner on the edge is
  /// where its own edges go to.
  int sideOf(int edge, int corner) const {
    int left = edge, right = next(edge);
    if (isLeftward(left, right)) std::swap(left, right);
    if (const int side = turn(left, right, corner)) return side;
    if (const int side = turn(left, right, next(corner))) return side;
    return turn(left, right, before(corner));
  }

  bool pass(int corner) {
    const int a = before(corner), b = next(corner);
    const bool a_is_left = isLeftward(corner, a), b_is_left = isLeftward(corner, b);
    if (a_is_left && b_is_left)
      return turn(a, corner, b) > 0 ? end(corner) : merge(corner);
    if (!a_is_left && !b_is_left)
      return turn(a, corner, b) > 0 ? begin(corner) : split(corner);
    Strip* const strip = owner(a_is_left ? a : corner);
    if (strip == nullptr) return false;
    if (a_is_left) {
      if (strip->lower != a) return false;
      setLower(*strip, corner);
      appendLow(*strip, corner);
    } else {
      if (strip->upper != corner) return false;
      setUpper(*strip, a);
      appendHigh(*strip, corner);
    }
    return true;
  }

  bool begin(int corner) {
    Strip& strip = addStrip();
    setLower(strip, corner);
    setUpper(strip, before(corner));
    strip.lo = strip.hi = strip.last = addLink(corner);
    return insert(strip, corner);
  }

  bool end(int corner) {
    Strip* const strip = owner(before(corner));
    if (strip == nullptr || strip != owner(corner) || strip->lower != before(corner) ||
        strip->upper != corner)
      return false;
    for (int at = strip->lo; link(at).after != -1; at = link(at).after) {
      const int from = link(at).corner, to = link(link(at).after).corner;
      if (turn(from, corner, to) < 0) return false;
      out_.push_back({from, corner, to});
    }
    strips_.erase(places_[strip->number]);
    return true;
  }

  /// A corner inside of a strip, from which the outside begins to the right.
  bool split(int corner) {
    const auto at = strips_.find(corner);
    if (at == strips_.end()) return false;
    Strip& low = **at;
    Strip& high = addStrip();
    setUpper(high, low.upper);
    setLower(high, corner);
    setUpper(low, before(corner));
    // Both get the link that the corner sees.
    const int seen = low.last, copy = addLink(link(seen).corner);
    link(copy).after = link(seen).after;
    if (link(copy).after != -1) link(link(copy).after).before = copy;
    link(seen).after = -1;
    high.lo = copy;
    high.hi = low.hi == seen ? copy : low.hi;
    low.hi = seen;
    appendHigh(low, corner);
    appendLow(high, corner);
    return insert(high, corner);
  }

  /// A corner at which the outside between two strips ends.
  bool merge(int corner) {
    Strip *const low = owner(corner), *const high = owner(before(corner));
    if (low == nullptr || high == nullptr || low == high || low->upper != corner ||
        high->lower != before(corner))
      return false;
    appendHigh(*low, corner);
    appendLow(*high, corner);
    // One link of the two that the corner now has.
    const int kept = low->hi, dropped = high->lo;
    link(kept).after = link(dropped).after;
    if (link(kept).after != -1) link(link(kept).after).before = kept;
    low->hi = high->hi == dropped ? kept : high->hi;
    low->last = kept;
    setUpper(*low, high->upper);
    strips_.erase(places_[high->number]);
    return true;
  }

  /// Whether a chain's end at a is cut off from the next corners on its two sides: it
  /// turns to the inside, or it has no width, as where a corner lies on another edge. One
  /// of b and c is the corner that is added, to the right of a.
  bool isCut(int a, int b, int c) const {
    const int side = turn(a, b, c);
    return side > 0 || (side == 0 && !isLeftward(a, b) && !isLeftward(a, c));
  }

  /// Adds a corner to the lower end of a strip's chain, with the triangles that it can
  /// make there.
  void appendLow(Strip& strip, int corner) {
    int at = strip.lo;
    for (int after = link(at).after; after != -1; after = link(at).after) {
      if (!isCut(link(at).corner, corner, link(after).corner)) break;
      out_.push_back({link(at).corner, corner, link(after).corner});
      at = after;
    }
    const int added = addLink(corner);
    link(added).after = at;
    link(at).before = added;
    strip.lo = strip.last = added;
  }

  void appendHigh(Strip& strip, int corner) {
    int at = strip.hi;
    for (int under = link(at).before; under != -1; under = link(at).before) {
      if (!isCut(link(at).corner, link(under).corner, corner)) break;
      out_.push_back({link(under).corner, corner, link(at).corner});
      at = under;
    }
    const int added = addLink(corner);
    link(added).before = at;
    link(at).after = added;
    strip.hi = strip.last = added;
  }

  Link& link(int i) {
    assert(i >= 0 && static_cast<std::size_t>(i) < links_.size());
    return links_[static_cast<std::size_t>(i)];
  }
  int addLink(int corner) {
    links_.push_back({corner, -1, -1});
    return static_cast<int>(links_.size()) - 1;
  }

  Strip*& owner(int edge) { return owner_[static_cast<std::size_t>(edge)]; }
  void setLower(Strip& strip, int edge) {
    strip.lower = edge;
    owner(edge) = &strip;
  }
  void setUpper(Strip& strip, int edge) {
    strip.upper = edge;
    owner(edge) = &strip;
  }

  Strip& addStrip() {
    storage_.emplace_back();
    storage_.back().number = storage_.size() - 1;
    places_.emplace_back();
    return storage_.back();
  }

  bool insert(Strip& strip, int corner) {
    new_strip_ = &strip;
    new_corner_ = corner;
    const auto [at, is_new] = strips_.insert(&strip);
    new_strip_ = nullptr;
    places_[strip.number] = at;
    return is_new;
  }

  const PolygonRings& rings_;
  std::vector<PolygonTriangle>& out_;
  std::deque<Strip> storage_;
  std::vector<Link> links_;
  const Strip* new_strip_{nullptr};
  int new_corner_{-1};
  Strips strips_;
  std::vector<Strips::iterator> places_;  ///< of each strip
  std::vector<Strip*> owner_;             ///< of each edge that is in a strip
};

}  // namespace

bool addSweptTriangles(const Vertices& vertices, const std::vector<int>& corners,
                       int axis, bool turns_left, Triangles& out) {
  const PolygonRings rings(vertices, corners, axis, turns_left);
  std::vector<PolygonTriangle> triangles;
  triangles.reserve(corners.size());
  if (!Sweep(rings, triangles).run()) return false;
  flipTowardsDelaunay(rings, triangles);
  const auto idOf = [&](int corner) { return corners[static_cast<std::size_t>(corner)]; };
  const auto add = [&](const PolygonTriangle& t) {
    out.push_back({idOf(t[0]), idOf(t[1]), idOf(t[2])});
  };
  std::for_each(triangles.begin(), triangles.end(), add);
  std::for_each(rings.removed().begin(), rings.removed().end(), add);
  return true;
}

}  // namespace fcl_ccd

// SPDX-License-Identifier: BSD-3-Clause
#include "curved/curved_contacts.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "advance/feature_advance.h"
#include "advance/turning_pairs.h"
#include "base/bits.h"
#include "base/parallel.h"
#include "bodies/common_motion.h"
#include "curved/chord_pairs.h"
#include "elementary/most_steps.h"
#include "elementary/predicates.h"
#include "mesh/feature_pairs.h"
#include "paths/posed_vector.h"
#include "query/contact_sink.h"
#include "query/contact_table.h"
#include "query/distance_contact.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

/// Free edges that a triangle has, and free points that are vertices of triangles or free
/// edges. They are no features of their own.
class FreeParts {
 public:
  explicit FreeParts(const MovingBody& body) {
    for (std::int32_t place = 0; place < body.numTriangles(); ++place) {
      const BodyTriangle leaf = body.triangle(place);
      if (leaf.isFreePoint()) continue;
      for (int k = 0; k < 3; ++k) {
        vertices_.insert(leaf.vertex[k]);
        if (!leaf.isFree()) edges_.insert(edgeOf(leaf, k));
      }
    }
  }
  bool contains(const BodyTriangle& leaf) const {
    if (leaf.isFreePoint()) return vertices_.count(leaf.vertex[0]) > 0;
    return leaf.isFree() && edges_.count(edgeOf(leaf, 0)) > 0;
  }

 private:
  using Edge = std::pair<std::int32_t, std::int32_t>;
  static Edge edgeOf(const BodyTriangle& triangle, int k) {
    return std::minmax({triangle.vertex[k], triangle.vertex[(k + 1) % 3]});
  }
  std::set<std::int32_t> vertices_;
  std::set<Edge> edges_;
};

class FeatureContacts {
 public:
  /// @param may_repeat  whether add() may get the same pair of features more than once
  FeatureContacts(const MovingBody& a, const MovingBody& b, const QueryOptions& options,
                  bool may_repeat)
      : body_{&a, &b},
        options_(options),
        tolerance_(a, b, options.min_distance),
        // Which contacts a first-contact query drops is known at the end only.
        sink_(options.query == ContinuousQuery::kAll ? options.max_contacts : kNoLimit,
              may_repeat) {
    if (options.filter && options.min_distance > 0)
      for (auto k : {0, 1})
        if (body_[k]->hasFree()) parts_[k] = std::make_shared<FreeParts>(*body_[k]);
  }

  /// An empty list of contacts of the same bodies, for a part of the pairs.
  FeatureContacts ofPart() const { return FeatureContacts(*this, Part()); }

  /// The contacts of features of pairs of triangles that touch. They do not depend on the
  /// number of threads.
  void add(const std::vector<CurvedContact>& triangles, double t_max) {
    // Which contacts a first-contact query wants depends on those before.
    if (options_.query != ContinuousQuery::kAll ||
        numThreads(options_.num_threads) == 1) {
      for (const CurvedContact& contact : triangles) add(contact, t_max);
      return;
    }
    constexpr std::size_t kBlock = 64;
    std::vector<std::deque<FeatureContact>> found((triangles.size() + kBlock - 1) /
                                                  kBlock);
    parallelForBlocks(triangles.size(), kBlock, options_.num_threads,
                      [&](std::size_t first, std::size_t end) {
                        FeatureContacts part = ofPart();
                        for (std::size_t i = first; i < end; ++i)
                          part.add(triangles[i], t_max);
                        found[first / kBlock] = part.sink_.takeContacts();
                      });
    for (const std::deque<FeatureContact>& contacts : found)
      for (const FeatureContact& contact : contacts) sink_.add(contact);
  }

  /// The contacts of the features that two triangles own, from the time at which the
  /// triangles touch.
  void add(const CurvedContact& contact, double t_max) {
    const BodyTriangle a = body_[0]->triangle(contact.place[0]),
                       b = body_[1]->triangle(contact.place[1]);
    for (unsigned pairs = pairsOf(a, b); pairs != 0; pairs &= pairs - 1)
      addPair(a, b, lowestBit(pairs), contact.toc_lo, t_max);
  }

  /// The contact of a pair of features, given by its number, from t on.
  /// @return whether there is one
  bool addPair(const BodyTriangle& a, const BodyTriangle& b, int bit, double t,
               double t_max) {
    if (t > latestWanted()) return false;
    if (tolerance_.distance > 0) return addPairAtDistance(a, b, bit, t, t_max);
    const FeaturePair pair = featurePair(bit);
    BodyTriangle x = a, y = b;
    if (pair.kind == ContinuousContactKind::kEdgeEdge) {
      x = featureOf(a, pair.first, (pair.first + 1) % 3);
      y = featureOf(b, pair.second, (pair.second + 1) % 3);
    } else {
      BodyTriangle& vertex = pair.first_on_a ? x : y;
      vertex = featureOf(vertex, pair.first, pair.first);
    }
    const auto& path_a = body_[0]->path();
    const auto& path_b = body_[1]->path();
    TriangleAdvance motion(path_a, x, path_b, y, t, t_max, tolerance_);
    int steps = kMostSteps;
    AdvanceCounts counts;  // of no interest
    if (motion.advance(t, t_max, steps, counts) == TriangleAdvance::Answer::kApart)
      return false;
    if (t > std::min(t_max, latestWanted())) return false;
    put(a, b, bit, t, provedTime(a, b, t, t_max));
    return true;
  }

  /// A contact of the features that are nearest when two triangles touch.
  void addNearest(const CurvedContact& contact) {
    const BodyTriangle a = body_[0]->triangle(contact.place[0]),
                       b = body_[1]->triangle(contact.place[1]);
    const double t = contact.toc_lo, hi = contact.toc_hi > t
                                              ? contact.toc_hi
                                              : provedTime(a, b, t, options_.t_max);
    put(a, b, pairOf(contact.nearest, a, b), t, hi);
  }

  /// Adds the edges of one triangle that pass through the other at t = 0.
  void addCrossings(const CurvedContact& contact, std::vector<Crossing>& out) const {
    const BodyTriangle x[2] = {body_[0]->triangle(contact.place[0]),
                               body_[1]->triangle(contact.place[1])};
    double p[2][3][3];
    for (int body = 0; body < 2; ++body) {
      const Pose pose = body_[body]->path().pose(0);
      for (int k = 0; k < 3; ++k) set(p[body][k], posed(pose, x[body].corner[0][k]));
    }
    for (int body = 0; body < 2; ++body)
      for (int k = 0; k < (x[body].isFree() ? 1 : 3); ++k) {
        const int end = (k + 1) % 3, other = 1 - body;
        if (!isCrossing(p[body][k], p[body][end], p[other][0], p[other][1], p[other][2]))
          continue;
        Crossing crossing;
        crossing.first_on_a = body == 0;
        crossing.edge[0] = static_cast<std::uint32_t>(x[body].vertex[k]);
        crossing.edge[1] = static_cast<std::uint32_t>(x[body].vertex[end]);
        for (int i = 0; i < 3; ++i)
          crossing.face[i] = static_cast<std::uint32_t>(x[other].vertex[i]);
        crossing.triangles[0] = x[0].index;
        crossing.triangles[1] = x[1].index;
        out.push_back(crossing);
      }
  }

  bool hasContactBy(double t) const {
    const auto& contacts = sink_.contacts();
    return std::any_of(contacts.begin(), contacts.end(),
                       [t](const FeatureContact& x) { return x.toc_lo <= t; });
  }

  ContactSink& sink() { return sink_; }

 private:
  struct Part {};
  FeatureContacts(const FeatureContacts& whole, Part)
      : body_{whole.body_[0], whole.body_[1]},
        parts_{whole.parts_[0], whole.parts_[1]},
        options_(whole.options_),
        tolerance_(whole.tolerance_),
        sink_(kNoLimit, false) {}

  /// The pairs of features that two triangles own. With a filter the owners may be left
  /// out: then each triangle stands for all its features.
  unsigned pairsOf(const BodyTriangle& a, const BodyTriangle& b) const {
    const bool at_distance = tolerance_.distance > 0;
    if (!options_.filter) return wantedPairs(a.owned, b.owned, at_distance);
    const auto isOwn = [this](int k, const BodyTriangle& leaf) {
      return !parts_[k] || !parts_[k]->contains(leaf);
    };
    const bool are_own = isOwn(0, a) && isOwn(1, b);
    return wantedPairs(featuresOf(a), featuresOf(b), at_distance && are_own);
  }

  static std::uint32_t featuresOf(const BodyTriangle& triangle) {
    constexpr std::uint32_t kFirst = 1, kFirstTwo = 3;
    if (triangle.isFreePoint()) return kFreeLeaf | kFirst;
    if (triangle.isFree()) return kFreeLeaf | kOwnsFirstEdge | kFirstTwo;
    std::uint32_t features = kOwnsAll;
    for (unsigned k = 0; k < 3; ++k)
      if (triangle.vertex[k] == triangle.vertex[(k + 1) % 3]) features &= ~(8U << k);
    return features;
  }

  /// The pair of features to which nearest ones belong, without a distance. A free leaf
  /// has one edge or one vertex.
  static int pairOf(const NearestFeatures& near, const BodyTriangle& a,
                    const BodyTriangle& b) {
    assert(!(a.isFreePoint() && b.isFree()) && !(b.isFreePoint() && a.isFree()));
    const auto vertexFace = [](bool first_on_a, const BodyTriangle& triangle, int k) {
      const int corner = triangle.isFree() ? std::min(k, 1) : k;
      return pairNumber({ContinuousContactKind::kVertexFace, first_on_a,
                         static_cast<unsigned>(corner), 0});
    };
    if (a.isFreePoint()) return vertexFace(true, a, 0);
    if (b.isFreePoint()) return vertexFace(false, b, 0);
    switch (near.kind) {
      case NearestFeatures::Kind::kVertexOfA:
        return vertexFace(true, a, near.a);
      case NearestFeatures::Kind::kVertexOfB:
        return vertexFace(false, b, near.b);
      default:
        return pairNumber({ContinuousContactKind::kEdgeEdge, true,
                           static_cast<unsigned>(a.isFree() ? 0 : near.a),
                           static_cast<unsigned>(b.isFree() ? 0 : near.b)});
    }
  }

  /// A contact that begins later is dropped at the end, and proves nothing for the
  /// others.
  double latestWanted() const {
    return options_.query == ContinuousQuery::kFirst ? sink_.firstHi() : 1;
  }

  /// A time after t at which the triangles provably cross; t if none is found.
  double provedTime(const BodyTriangle& a, const BodyTriangle& b, double t,
                    double t_max) {
    // Flat triangles touch with many features at the same time.
    Proof& proof = last_proof_;
    if (proof.t == t && proof.t_max == t_max && proof.triangle[0] == a.index &&
        proof.triangle[1] == b.index)
      return proof.hi;
    const TriangleAdvance pair(body_[0]->path(), a, body_[1]->path(), b, t, t_max,
                               tolerance_);
    const double hi = pair.proveContact(
        t, TriangleAdvance::bracketWidth(t, options_.toc_err, options_.t_max));
    proof = {{a.index, b.index}, t, t_max, hi};
    return hi;
  }

  bool addPairAtDistance(const BodyTriangle& a, const BodyTriangle& b, int bit, double t,
                         double t_max) {
    FeatureAdvance motion(body_[0]->path(), a, body_[1]->path(), b, bit, t, t_max,
                          tolerance_);
    if (options_.ignores_initially_closer && t == 0) motion.ignoreInitiallyCloser();
    AdvanceCounts counts;  // of no interest
    if (motion.advance(t, counts) == TriangleAdvance::Answer::kApart) return false;
    const DistanceContact found = motion.contactAt(
        t, TriangleAdvance::bracketWidth(t, options_.toc_err, options_.t_max));
    sink_.add(contactOf(idsOf(bit, a, b), found, false));
    return true;
  }

  void put(const BodyTriangle& a, const BodyTriangle& b, int bit, double lo, double hi) {
    // A contact at the beginning has exactly the time 0.
    sink_.add({idsOf(bit, a, b), lo, lo == 0 ? 0 : hi});
  }

  /// The times of provedTime().
  struct Proof {
    std::int32_t triangle[2]{-1, -1};
    double t{-1}, t_max{-1}, hi{-1};
  };
  static constexpr std::size_t kNoLimit = static_cast<std::size_t>(-1);
  const MovingBody* body_[2];
  /// The free parts of each mesh, in queries with a filter and a distance. Null if the
  /// mesh has none.
  std::shared_ptr<const FreeParts> parts_[2];
  const QueryOptions& options_;
  BodyTolerance tolerance_;
  ContactSink sink_;
  Proof last_proof_;
};

/// The contacts of pairs of features that come near on chords, span by span.
class ChordContacts {
 public:
  /// @param has_windows  ChordSearch::listsWindows()
  ChordContacts(const MovingBody& a, const MovingBody& b, const QueryOptions& options,
                bool has_windows)
      : body_{&a, &b},
        options_(options),
        places_{a.placesOfTriangles(), b.placesOfTriangles()},
        features_(a, b, options, false),
        has_windows_(has_windows) {}

  /// Adds the contacts in a span, except for those of pairs that had one before.
  void add(const ChordSearch::Span& span) {
    constexpr std::size_t kBlock = 4096;
    const std::size_t count = span.near.contacts.size();
    std::vector<Found> found((count + kBlock - 1) / kBlock);
    parallelForBlocks(count, kBlock, options_.num_threads,
                      [&](std::size_t first, std::size_t last) {
                        found[first / kBlock] = advance(span, first, last);
                      });
    for (const Found& part : found) {
      for (const FeatureContact& contact : part.contacts) features_.sink().add(contact);
      for (const FeatureContact* pair : part.pairs) keepOut(*pair, span);
    }
  }

  ContactSink& sink() { return features_.sink(); }

 private:
  /// Contacts, and the pairs that have them.
  struct Found {
    std::deque<FeatureContact> contacts;
    std::vector<const FeatureContact*> pairs;
  };

  /// Advances the pairs of a span with these numbers.
  Found advance(const ChordSearch::Span& span, std::size_t first,
                std::size_t last) const {
    Found found;
    FeatureContacts alone = features_.ofPart();
    // Without windows pairs are advanced one by one.
    std::optional<TurningBatch> turning;
    if (has_windows_) turning.emplace(*body_[0], *body_[1], options_);
    const auto take = [&](const FeatureContact& pair, const TurningAnswer& answer) {
      bool is_contact = answer.is_contact;
      if (answer.is_open)
        is_contact = addAlone(pair, span, alone);
      else if (is_contact)
        alone.sink().add({pair, answer.toc_lo, answer.toc_hi});
      if (is_contact) found.pairs.push_back(&pair);
    };
    for (std::size_t i = first; i < last; ++i) {
      const FeatureContact& pair = span.near.contacts[i];
      // Spans list by time, up to a rounding after t_max.
      if (firstOf(pair, span) > options_.t_max || in_contact_.find(pair)) continue;
      if (turning)
        addTurning(pair, span, *turning, take);
      else if (addAlone(pair, span, alone))
        found.pairs.push_back(&pair);
    }
    if (turning) turning->finish(take);
    found.contacts = alone.sink().takeContacts();
    return found;
  }

  BodyTriangle triangleOf(const FeatureContact& pair, int k) const {
    const std::int32_t id = pair.triangles[k];
    const std::vector<std::int32_t>& places = places_[k];
    assert(id >= 0 && (places.empty() || static_cast<std::size_t>(id) < places.size()));
    const BodyTriangle triangle =
        body_[k]->triangle(places.empty() ? id : places[static_cast<std::size_t>(id)]);
    assert(triangle.index == id);
    return triangle;
  }

  /// The number of a pair of features of two triangles.
  static int numberOf(const FeatureIds& pair, const BodyTriangle& a,
                      const BodyTriangle& b) {
    const auto vertexOf = [&pair](const BodyTriangle& triangle, int i) {
      const auto id = static_cast<std::int32_t>(pair.vertices[i]);
      const unsigned k = triangle.vertex[0] == id   ? 0U
                         : triangle.vertex[1] == id ? 1U
                                                    : 2U;
      assert(triangle.vertex[k] == id);
      return k;
    };
    const auto edgeOf = [&](const BodyTriangle& triangle, int i) {
      const unsigned first = vertexOf(triangle, i), second = vertexOf(triangle, i + 1);
      return (first + 1) % 3 == second ? first : second;
    };
    if (pair.kind == ContinuousContactKind::kEdgeEdge)
      return pairNumber({pair.kind, true, edgeOf(a, 0), edgeOf(b, 2)});
    return pairNumber(
        {pair.kind, pair.first_on_a, vertexOf(pair.first_on_a ? a : b, 0), 0});
  }

  double lastOf(const ChordSearch::Span& span) const {
    return std::min(span.t1, options_.t_max);
  }
  /// The time at a share of a span, moved towards an end of the step by more than its
  /// rounding. The length of a span is exact. If it is a power of two only the sum below
  /// rounds, else the product too, by half a unit of less than the sum.
  static double timeBeyond(const ChordSearch::Span& span, double share, double end) {
    assert(0 <= share && share <= 1);
    const double dt = span.t1 - span.t0, t = std::nextafter(span.t0 + share * dt, end);
    int exponent;
    return std::frexp(dt, &exponent) == 0.5 ? t : std::nextafter(t, end);
  }
  /// A time before which the pair is apart during the span.
  static double firstOf(const FeatureContact& pair, const ChordSearch::Span& span) {
    if (pair.toc_lo == 0) return span.t0;
    return std::max(timeBeyond(span, pair.toc_lo, 0), span.t0);
  }

  template <typename Take>
  void addTurning(const FeatureContact& pair, const ChordSearch::Span& span,
                  TurningBatch& turning, Take&& take) const {
    const BodyTriangle a = triangleOf(pair, 0), b = triangleOf(pair, 1);
    turning.add({pair, a, b, featurePair(numberOf(pair, a, b)), firstOf(pair, span),
                 std::min(timeBeyond(span, pair.toc_hi, 1), lastOf(span))},
                take);
  }

  /// Advances one pair.
  /// @return whether it has a contact
  bool addAlone(const FeatureContact& pair, const ChordSearch::Span& span,
                FeatureContacts& features) const {
    const BodyTriangle a = triangleOf(pair, 0), b = triangleOf(pair, 1);
    return features.addPair(a, b, numberOf(pair, a, b), firstOf(pair, span),
                            lastOf(span));
  }

  /// Leaves a pair out in the spans after this one.
  void keepOut(const FeatureIds& pair, const ChordSearch::Span& span) {
    if (!(span.t1 < 1)) return;
    pairs_.push_back(pair);
    in_contact_.add(pairs_.back());
  }

  const MovingBody* body_[2];
  const QueryOptions& options_;
  /// For each triangle its place in the tree; empty: they are the same.
  std::vector<std::int32_t> places_[2];
  FeatureContacts features_;
  const bool has_windows_;
  /// Pairs that have a contact in an earlier span.
  std::deque<FeatureIds> pairs_;
  ContactTable<FeatureIds> in_contact_;
};

/// Keeps the contacts that the query wants: those that may be the first, or one.
/// @return whether max_contacts dropped some
bool keepWanted(const QueryOptions& options, double first_hi,
                std::deque<FeatureContact>& contacts) {
  if (options.query == ContinuousQuery::kAll || contacts.empty()) return false;
  const auto is_late = [first_hi](const FeatureContact& contact) {
    return contact.toc_lo > first_hi;
  };
  contacts.erase(std::remove_if(contacts.begin(), contacts.end(), is_late),
                 contacts.end());
  const bool any = options.query == ContinuousQuery::kAny;
  const std::size_t room = any ? 1 : options.max_contacts;
  if (contacts.size() <= room) return false;
  std::sort(contacts.begin(), contacts.end(), isEarlier);
  contacts.resize(room);
  return !any;
}

void count(const AdvanceCounts& from, StageCounts& to) {
  to.node_pairs += from.box_tests;
  to.triangle_pairs += from.triangle_pairs;
}

void count(const StageCounts& from, StageCounts& to) {
  to.node_pairs += from.node_pairs;
  to.triangle_pairs += from.triangle_pairs;
}

/// Moves the contacts that the query wants into the answer.
void complete(const QueryOptions& options, ContactSink& sink, QueryAnswer& answer) {
  const double first_hi = sink.firstHi();
  answer.cut = sink.isCut();
  std::vector<std::deque<FeatureContact>> lists(1, sink.takeContacts());
  answer.cut |= keepWanted(options, first_hi, lists.front());
  answer.contacts = SortedContacts(std::move(lists));
  if (!answer.contacts.empty())
    answer.first = {answer.contacts.front().toc_lo, answer.contacts.front().toc_hi};
  assert(answer.contacts.size() <= options.max_contacts);
  answer.counts.contacts = answer.contacts.size();
}

/// The contacts of triangles that may be the first.
CurvedAnswer firstTriangles(const MovingBody& a, const MovingBody& b,
                            CurvedAnswer touching, CurvedOptions& wanted) {
  assert(!touching.contacts.empty());
  if (wanted.any) {
    // It need not be the first, and very many others may touch by then.
    wanted.any = false;
    touching = queryCurved(a, b, wanted);
    if (touching.contacts.empty()) return touching;
  }
  wanted.all = true;
  wanted.proves_contacts = false;
  wanted.t_max = touching.contacts.front().toc_hi;
  CurvedAnswer first = queryCurved(a, b, wanted);
  // A graze has a bracket without width. The query up to its end divides the step in
  // another way, and may see nothing yet. Then the contact that was found is the answer.
  return first.contacts.empty() ? touching : first;
}

/// Adds the contacts of features, and crossings, of triangles in contact until a time.
void addFeatures(const CurvedAnswer& triangles, double t_max, const QueryOptions& options,
                 const FeatureContacts& unmoved, FeatureContacts& features,
                 QueryAnswer& answer) {
  for (const CurvedContact& contact : triangles.contacts)
    if (contact.toc_lo == 0 && (options.all_crossings || answer.crossings.empty()))
      unmoved.addCrossings(contact, answer.crossings);
  features.add(triangles.contacts, t_max);
  if (options.all_crossings) sortCrossings(answer.crossings);
}

/// Adds the contacts of features, and crossings, of two bodies.
/// @param wanted  what gave the triangles
void addFeatures(const MovingBody& a, const MovingBody& b, CurvedAnswer triangles,
                 CurvedOptions wanted, const QueryOptions& options,
                 FeatureContacts& features, QueryAnswer& answer) {
  const FeatureContacts unmoved(a, b, options, false);
  if (options.query == ContinuousQuery::kAny && !wanted.all) {
    // As a rule features of these triangles touch as early as they do.
    CurvedAnswer first;
    first.contacts.push_back(triangles.contacts.front());
    addFeatures(first, first.contacts[0].toc_hi, options, unmoved, features, answer);
    if (features.hasContactBy(first.contacts[0].toc_lo)) return;
  }
  if (!wanted.all) triangles = firstTriangles(a, b, std::move(triangles), wanted);
  addFeatures(triangles, wanted.t_max, options, unmoved, features, answer);
  if (!features.sink().contacts().empty() || answer.hasCrossing()) return;
  // Features that pass at the distance of the tolerance may round differently than
  // their triangles.
  if (!(options.min_distance > 0)) return features.addNearest(triangles.contacts.front());
  // Triangles that were given up may be apart.
  if (wanted.t_max == options.t_max) return;
  wanted.t_max = options.t_max;
  addFeatures(queryCurved(a, b, wanted), wanted.t_max, options, unmoved, features,
              answer);
}

/// A query that needs no more takes less time than to begin with chords.
constexpr std::uint64_t kFewBoxTests = 512;

/// Looks for any contact, for a small part of the time that all contacts take. Surfaces
/// that slide along each other are near during the whole step, and boxes that turn with
/// them prove many times faster than chords that there is none.
CurvedAnswer lookForAny(const MovingBody& a, const MovingBody& b, CurvedOptions wanted,
                        int num_spans) {
  // Of tubes of 10,000 vertices in each other, 7 box tests for each vertex prove a turn
  // by half a degree, of tubes of 40,000 with the same gap one and a half; and 42 a turn
  // by 90 degrees, in which chords have 16 spans. Chords take five times as long for
  // these.
  constexpr std::uint64_t kTestsOfVertex = 8;
  wanted.all = false;
  wanted.any = true;
  wanted.proves_contacts = false;
  wanted.most_box_tests = kTestsOfVertex * static_cast<std::uint64_t>(num_spans) *
                          (a.numVertices() + b.numVertices());
  return queryCurved(a, b, wanted);
}

/// All contacts of two meshes that come near each other.
QueryAnswer contactsBy(ChordSearch& chords, const MovingBody& a, const MovingBody& b,
                       const QueryOptions& options) {
  QueryAnswer answer;
  const BodiesNearOrigin near(a, b);
  ChordContacts contacts(near.a, near.b, options, chords.listsWindows());
  for (int i = 0; i < chords.numSpans(); ++i) {
    ChordSearch::Span span = chords.find(i);
    if (i == 0) answer.crossings = std::move(span.near.crossings);
    count(span.near.counts, answer.counts);
    contacts.add(span);
  }
  complete(options, contacts.sink(), answer);
  return answer;
}

}  // namespace

QueryAnswer queryCurvedContacts(const MovingBody& a, const MovingBody& b,
                                const QueryOptions& requested) {
  assert(a.isMesh() && b.isMesh());
  QueryOptions options = requested;
  const BodiesNearOrigin near(a, b);
  if (moveAsOne(near.a, near.b, options.min_distance)) options.t_max = 0;
  CurvedOptions wanted = curvedOptionsOf(a, b, options);
  if (ChordSearch::isFor(a, b, options)) wanted.most_box_tests = kFewBoxTests;
  CurvedAnswer touching = queryCurved(a, b, wanted);
  if (touching.is_cut) {
    ChordSearch chords(a, b, options);
    wanted.most_box_tests = chords.boxTestsBefore();
    if (wanted.most_box_tests > kFewBoxTests) touching = queryCurved(a, b, wanted);
    if (touching.is_cut) {
      touching = lookForAny(a, b, wanted, chords.numSpans());
      if (touching.is_cut || !touching.contacts.empty())
        return contactsBy(chords, a, b, options);
    }
  }
  wanted.most_box_tests = CurvedOptions().most_box_tests;
  QueryAnswer answer;
  count(touching.counts, answer.counts);
  if (touching.contacts.empty()) return answer;
  // Rigid meshes have no owners.
  FeatureContacts features(near.a, near.b, options,
                           options.filter || a.isRigid() || b.isRigid());
  if (options.only_time)
    features.addNearest(touching.contacts.front());
  else
    addFeatures(a, b, std::move(touching), wanted, options, features, answer);
  complete(options, features.sink(), answer);
  return answer;
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl

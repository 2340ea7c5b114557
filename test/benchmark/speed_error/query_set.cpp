// SPDX-License-Identifier: BSD-3-Clause
#include "query_set.h"

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <random>
#include <set>
#include <stdexcept>

#include "elementary/elementary.h"
#include "elementary/exact.h"
#include "fcl/geometry/bvh/deformable_bvh_model.h"
#include "query/deformable_query.h"
#include "query_csv.h"
#include "query_generators.h"
#include "scene_data.h"

namespace fcl {
namespace test {
namespace {

namespace deformable = detail::deformable;
namespace fs = std::filesystem;
using fcl::ContinuousContactKind;

/// Far below every error that a method makes other than by rounding.
constexpr double kTruthErr = 1e-15;

Truth decided(const MovingPair& query) {
  const auto r = deformable::decideExactly(query.kind, query.points(), kTruthErr);
  return {r.answer == deformable::Answer::kYes, r.toc_lo, r.toc_hi};
}

/// Whether and when, with the first known from elsewhere; times are asked of contacts
/// only, since the exact stage is dear.
Truth withTime(const MovingPair& query, bool contact) {
  if (!contact) return {false, 0, 0};
  const Truth truth = decided(query);
  if (!truth.contact)
    throw std::runtime_error("the exact stage denies a contact of the reference");
  return truth;
}

/// A feature pair of a mesh: v, f0, f1, f2 or ea0, ea1, eb0, eb1.
struct NamedPair {
  ContinuousContactKind kind;
  std::array<int, 4> v;
};

std::vector<NamedPair> pairsWhoseBoxesMeet(const FramePairMesh& mesh) {
  DeformableBVHModel<> model;
  model.beginModel(static_cast<int>(mesh.triangles.size()),
                   static_cast<int>(mesh.previous.size()));
  model.addSubModel(mesh.previous, mesh.triangles);
  model.endModel(FclTree::kSkip);
  model.updateFrames(mesh.previous.front().data(), mesh.current.front().data(),
                     mesh.previous.size(), FclTree::kSkip);
  deformable::MeshInstance instance;
  instance.frames = model.frames();
  instance.tree = &model.movingTree();
  std::vector<NamedPair> found;
  deformable::candidatesSelf(
      instance, [&found](const deformable::FeatureCandidate* block, std::size_t count) {
        for (std::size_t i = 0; i < count; ++i) {
          const auto id = [&](int k) { return static_cast<int>(block[i].vertices[k]); };
          found.push_back({block[i].kind, {id(0), id(1), id(2), id(3)}});
        }
        return true;
      });
  return found;
}

MovingPair pairOf(const FramePairMesh& mesh, const NamedPair& pair) {
  MovingPair out{pair.kind, {}};
  for (std::size_t i = 0; i < 4; ++i) {
    const auto v = static_cast<std::size_t>(pair.v[i]);
    for (int k = 0; k < 3; ++k) {
      out.x[i].t0[k] = mesh.previous[v][k];
      out.x[i].t1[k] = mesh.current[v][k];
    }
  }
  return out;
}

}  // namespace

QuerySet readHardQueries(const std::string& folder) {
  QuerySet set{"hard", {}, {}};
  std::set<fs::path> folders;  // in an order that does not depend on the file system
  for (const auto& entry : fs::directory_iterator(folder)) folders.insert(entry.path());
  for (const fs::path& path : folders)
    for (const ContinuousContactKind kind :
         {ContinuousContactKind::kVertexFace, ContinuousContactKind::kEdgeEdge}) {
      const fs::path file =
          path / (kind == ContinuousContactKind::kVertexFace ? "vertex-face.csv"
                                                             : "edge-edge.csv");
      if (!fs::exists(file)) continue;
      const fcl_ccd::QueryList list = fcl_ccd::readQueries(file.string());
      if (!list.has_truth) throw std::runtime_error(file.string() + ": has no truth");
      for (const auto& query : list.queries) {
        set.queries.push_back({kind, query.x});
        set.truth.push_back(withTime(set.queries.back(), query.truth));
      }
    }
  return set;
}

QuerySet collectScene(const SceneFolder& scene, std::size_t sample) {
  const fs::path folder = scene.path;
  const FramePairMesh mesh = readFramePair((folder / scene.previous).string(),
                                           (folder / scene.current).string());
  const std::set<PairName> contacts =
      readTruePairs((folder / "true_pairs.csv.gz").string());
  const std::vector<NamedPair> all = pairsWhoseBoxesMeet(mesh);
  std::vector<NamedPair> drawn;
  std::sample(all.begin(), all.end(), std::back_inserter(drawn), sample,
              std::mt19937_64(1));
  QuerySet set{scene.name, {}, {}};
  for (const NamedPair& pair : drawn) {
    set.queries.push_back(pairOf(mesh, pair));
    const ContinuousContactKind kind = pair.kind == ContinuousContactKind::kVertexFace
                                           ? ContinuousContactKind::kVertexFace
                                           : ContinuousContactKind::kEdgeEdge;
    const bool contact = contacts.count(pairName(kind, pair.v)) > 0;
    set.truth.push_back(withTime(set.queries.back(), contact));
  }
  return set;
}

QuerySet generateQueries(std::size_t count, std::uint64_t seed) {
  std::vector<const QueryFamily*> families[2];
  for (const QueryFamily& family : queryFamilies())
    families[family.is_degenerate].push_back(&family);
  Random random(seed);
  QuerySet set{"generated", {}, {}};
  for (std::size_t i = 0; i < count; ++i) {
    const auto& half = families[i % 2];
    set.queries.push_back(half[i / 2 % half.size()]->generate(random));
    set.truth.push_back(decided(set.queries.back()));
  }
  return set;
}

}  // namespace test
}  // namespace fcl

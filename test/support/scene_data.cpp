// SPDX-License-Identifier: BSD-3-Clause
#include "scene_data.h"

#include <zlib.h>

#include <algorithm>
#include <cstdio>
#include <memory>
#include <stdexcept>

#include "mesh_files.h"

namespace fcl {
namespace test {
namespace {

std::vector<Vector3<double>> toVectors(const fcl_ccd::Mesh& mesh) {
  std::vector<Vector3<double>> points;
  points.reserve(mesh.vertices.size());
  for (const auto& p : mesh.vertices) points.emplace_back(p[0], p[1], p[2]);
  return points;
}

}  // namespace

PairName pairName(ContinuousContactKind kind, std::array<int, 4> v) {
  if (kind == ContinuousContactKind::kVertexFace) {
    std::sort(v.begin() + 1, v.end());
    return {0, v[0], v[1], v[2], v[3]};
  }
  std::sort(v.begin(), v.begin() + 2);
  std::sort(v.begin() + 2, v.end());
  if (std::make_pair(v[2], v[3]) < std::make_pair(v[0], v[1])) {
    std::swap(v[0], v[2]);
    std::swap(v[1], v[3]);
  }
  return {1, v[0], v[1], v[2], v[3]};
}

std::set<PairName> readTruePairs(const std::string& path) {
  const std::unique_ptr<gzFile_s, int (*)(gzFile)> file(gzopen(path.c_str(), "rb"),
                                                        gzclose);
  if (!file) throw std::runtime_error(path + ": cannot be opened");
  std::set<PairName> pairs;
  char line[256];
  while (gzgets(file.get(), line, sizeof line)) {
    if (line[0] == '#') continue;
    std::array<int, 4> v{};
    const bool vf = line[0] == 'v';
    if (std::sscanf(line + 2, ",%d,%d,%d,%d", &v[0], &v[1], &v[2], &v[3]) != 4)
      throw std::runtime_error(path + ": not a pair: " + line);
    pairs.insert(pairName(
        vf ? ContinuousContactKind::kVertexFace : ContinuousContactKind::kEdgeEdge, v));
  }
  return pairs;
}

FramePairMesh readFramePair(const std::string& previous, const std::string& current) {
  const fcl_ccd::Mesh a = readMesh(previous), b = readMesh(current);
  if (a.triangles != b.triangles || a.vertices.size() != b.vertices.size())
    throw std::runtime_error(current + ": topology differs from " + previous);
  FramePairMesh mesh{toVectors(a), toVectors(b), {}};
  for (const auto& t : a.triangles)
    mesh.triangles.emplace_back(static_cast<std::size_t>(t[0]),
                                static_cast<std::size_t>(t[1]),
                                static_cast<std::size_t>(t[2]));
  return mesh;
}

}  // namespace test
}  // namespace fcl

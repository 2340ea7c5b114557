// SPDX-License-Identifier: BSD-3-Clause
//
// An engine's step with continuous collision detection: a cloth is thrown onto a sheet
// without thickness, at 60 steps a second. A step proposes positions, contact_response.h
// changes them until the way there is free of contacts. Without that the cloth falls
// through the sheet.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include <fcl/geometry/bvh/deformable_bvh_model.h>
#include <fcl/narrowphase/continuous_collision.h>

#include "contact_response.h"

namespace {

using contact_response::Positions;

constexpr int kQuads = 16;
constexpr int kSteps = 90;
constexpr double kTime = 1 / 60.;  // seconds

struct Mesh {
  Positions vertices;
  std::vector<fcl::Triangle> triangles;
};

/// Adds a square with its middle at a height.
void addSquare(Mesh& mesh, int quads, double size, double height) {
  const std::size_t first = mesh.vertices.size(),
                    row = static_cast<std::size_t>(quads) + 1;
  for (std::size_t i = 0; i < row; ++i)
    for (std::size_t j = 0; j < row; ++j)
      mesh.vertices.emplace_back(size * (double(i) / quads - .5),
                                 size * (double(j) / quads - .5), height);
  for (std::size_t i = 0; i + 1 < row; ++i)
    for (std::size_t j = 0; j + 1 < row; ++j) {
      const std::size_t v = first + i * row + j;
      mesh.triangles.emplace_back(v, v + row, v + 1);
      mesh.triangles.emplace_back(v + 1, v + row, v + row + 1);
    }
}

/// Holds the lengths of the cloth's edges, as far as a few passes do.
void holdLengths(const Mesh& rest, const std::vector<double>& inverse_masses,
                 Positions& positions) {
  for (int pass = 0; pass < 15; ++pass)
    for (const fcl::Triangle& t : rest.triangles)
      for (int k = 0; k < 3; ++k) {
        const std::size_t v = t[k], w = t[(k + 1) % 3];
        if (inverse_masses[v] == 0) continue;
        const fcl::Vector3d way = positions[w] - positions[v];
        const double wanted = (rest.vertices[w] - rest.vertices[v]).norm();
        const fcl::Vector3d half = .5 * (1 - wanted / way.norm()) * way;
        positions[v] += half;
        positions[w] -= half;
      }
}

struct Outcome {
  std::size_t unanswered{0};  // contacts on the ways that were taken
  double lowest{0};           // above the sheet
  int queries{0};
  std::size_t stopped{0};
};

Outcome simulate(bool responds) {
  Mesh mesh;
  addSquare(mesh, kQuads, 1, .3);  // the cloth
  const std::size_t cloth = mesh.vertices.size();
  addSquare(mesh, 4, 2, 0);  // the sheet
  // The cloth is a little uneven, or all of it would meet the sheet at one time.
  for (std::size_t v = 0; v < cloth; ++v)
    mesh.vertices[v].z() +=
        .02 * std::sin(7 * mesh.vertices[v].x() + 4 * mesh.vertices[v].y());
  std::vector<double> inverse_masses(mesh.vertices.size(), 0);
  std::fill_n(inverse_masses.begin(), cloth, 1);

  fcl::DeformableBVHModel<> model;
  model.beginModel();
  model.addSubModel(mesh.vertices, mesh.triangles);
  model.endModel(fcl::FclTree::kSkip);

  contact_response::Options options{};
  options.margin = 2e-3;
  Positions x = mesh.vertices, v(x.size(), fcl::Vector3d::Zero());
  for (std::size_t i = 0; i < cloth; ++i) v[i] = fcl::Vector3d(1, .5, -4);
  Outcome outcome;
  contact_response::Memory memory;
  for (int step = 0; step < kSteps; ++step) {
    // What any engine does: positions that it would like to have.
    Positions next = x;
    for (std::size_t i = 0; i < cloth; ++i)
      next[i] += kTime * (v[i] + kTime * fcl::Vector3d(0, 0, -9.81));
    holdLengths(mesh, inverse_masses, next);
    for (std::size_t i = 0; i < cloth; ++i) v[i] = .99 * (next[i] - x[i]) / kTime;

    if (responds) {
      const contact_response::Report report = contact_response::respond(
          model, options, inverse_masses, x, kTime, next, v, &memory);
      outcome.queries += report.queries;
      outcome.stopped += report.stopped;
    }
    // Contacts on the way that is taken.
    model.updateFrames(x[0].data(), next[0].data(), x.size());
    fcl::ContinuousContactResultd found;
    fcl::continuousSelfCollide(&model, fcl::ContinuousContactRequestd(), found);
    outcome.unanswered += found.contacts.size() + (found.initially_crossing ? 1 : 0);
    x = next;
  }
  outcome.lowest = 1;
  for (std::size_t i = 0; i < cloth; ++i)
    if (std::abs(x[i].x()) < 1 && std::abs(x[i].y()) < 1)
      outcome.lowest = std::min(outcome.lowest, x[i].z());
  return outcome;
}

}  // namespace

int main() {
  const Outcome without = simulate(false), with = simulate(true);
  std::printf("without: %zu contacts not answered, lowest point at %.3f\n",
              without.unanswered, without.lowest);
  std::printf(
      "with:    %zu contacts not answered, lowest point at %.3f, %.1f queries a step, "
      "%zu vertices stopped\n",
      with.unanswered, with.lowest, double(with.queries) / kSteps, with.stopped);
  return without.unanswered > 0 && without.lowest < 0 && with.unanswered == 0 &&
                 with.lowest > 0
             ? 0
             : 1;
}

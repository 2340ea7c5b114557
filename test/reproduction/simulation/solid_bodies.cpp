// SPDX-License-Identifier: BSD-3-Clause
//
// The part of the simulator that makes solids and breaks them.
#include <algorithm>
#include <cmath>

#include "cloth_simulator.h"
#include "fcl/common/exception.h"

namespace fcl {
namespace test {
namespace {

double areaOf(const TestMesh& mesh) {
  double area = 0;
  for (const Triangle& t : mesh.triangles) {
    const Vector3<double> a = mesh.vertices[t[1]] - mesh.vertices[t[0]];
    const Vector3<double> b = mesh.vertices[t[2]] - mesh.vertices[t[0]];
    area += 0.5 * a.cross(b).norm();
  }
  return area;
}

}  // namespace

/// A body of vertices with equal masses and rest positions `places`. Fills rest_.
ClothSimulator::Solid ClothSimulator::makeSolid(
    const std::vector<int>& vertices, const std::vector<Vector3<double>>& places,
    double vertex_mass, const SolidOptions& options) {
  Solid solid;
  std::vector<Vector3<double>> rest;
  for (const int v : vertices) rest.push_back(places[v]);
  solid.offset =
      solid.body.setMasses(rest, std::vector<double>(rest.size(), vertex_mass));
  for (const int v : vertices) rest_[v] = places[v] - solid.offset;
  solid.body.vertices = vertices;
  solid.body.frequency = options.frequency;
  solid.body.velocity.centre = options.velocity;
  solid.body.begin.centre = solid.body.end.centre = solid.offset;
  return solid;
}

int ClothSimulator::addSolid(const TestMesh& mesh, const SolidOptions& options) {
  const int first = addBody(mesh, Kind::kSolid, {});
  std::vector<int> vertices;
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
    vertices.push_back(first + static_cast<int>(v));
  const double vertex_mass =
      options.density * areaOf(mesh) / static_cast<double>(vertices.size());
  for (const int v : vertices) solid_of_[v] = static_cast<int>(solids_.size());
  solids_.push_back(makeSolid(vertices, mesh_.vertices, vertex_mass, options));
  return first;
}

int ClothSimulator::addFragile(const ShellDesign& design, const SolidOptions& options,
                               const FragileOptions& fragile) {
  FragileShell surface(design);
  const TestMesh mesh = surface.mesh();
  surface.place(static_cast<int>(mesh_.vertices.size()),
                static_cast<int>(mesh_.triangles.size()));
  const double vertex_mass =
      options.density * areaOf(mesh) / static_cast<double>(mesh.vertices.size());
  const int first = addSolid(mesh, options);
  solids_.back().shell = static_cast<int>(shells_.size());
  solids_.back().pieces = surface.numPieces();
  const std::vector<int> solid_of_piece(surface.numPieces(),
                                        static_cast<int>(solids_.size()) - 1);
  const Vector3<double> middle = solids_.back().offset;
  shells_.push_back(
      {std::move(surface), fragile, vertex_mass, middle, solid_of_piece, false});
  return first;
}

/// Breaks the bonds that are near blows too strong for them.
void ClothSimulator::loadBonds() {
  struct Blow {
    Vector3<double> place;  // in the shell's design
    double impulse;         // N s
  };
  std::vector<std::vector<Blow>> blows(solids_.size());
  for (const ContactConstraint& c : contacts_)
    for (const SolidShare& share : c.solids) {
      if (share.solid < 0 || c.impulse == 0) continue;
      const Solid& solid = solids_[share.solid];
      if (solid.shell >= 0)
        blows[share.solid].push_back(
            {share.rest / share.weight + solid.offset, c.impulse / stepTime()});
    }
  for (std::size_t i = 0; i < shells_.size(); ++i) {
    Shell& shell = shells_[i];
    const std::vector<int>& solid_of_piece = shell.solid_of_piece;
    for (FragileShell::Bond& bond : shell.surface.bonds()) {
      if (bond.is_broken) continue;
      double load = 0;
      for (const Blow& blow : blows[solid_of_piece[bond.piece_a]])
        load += blow.impulse *
                std::exp(-(blow.place - bond.place).norm() / shell.options.reach);
      if (load < bond.strength) continue;
      bond.is_broken = true;
      shell.is_loaded = true;
    }
  }
}

/// Splits the surfaces whose bonds broke during the previous frame.
void ClothSimulator::breakShells() {
  change_ = {};
  change_.first_new_triangle = mesh_.triangles.size();
  change_.first_new_vertex = mesh_.vertices.size();
  for (std::size_t i = 0; i < shells_.size(); ++i) {
    Shell& shell = shells_[i];
    if (!shell.is_loaded) continue;
    shell.is_loaded = false;
    std::vector<Vector3<double>> design = rest_;
    for (const Solid& solid : solids_)
      if (solid.shell == static_cast<int>(i))
        for (const int v : solid.body.vertices) design[v] += solid.offset;
    const std::vector<int> part_of_piece = shell.surface.findParts();
    shell.surface.split(part_of_piece, shell.options.gap, mesh_.triangles, design,
                        change_);
    divideSolids(static_cast<int>(i), part_of_piece, design);
  }
  if (change_.isEmpty()) return;
  moved_ = mesh_.vertices;
  const double* place = mesh_.vertices[0].data();
  if (model_.updateTopology(mesh_.triangles, {}, place, place, mesh_.vertices.size()) !=
      BVH_OK)
    throw Exception("ClothSimulator: " + model_.lastError());
}

/// Gives each part a body of its own, with the motion that the part had in the whole.
void ClothSimulator::divideSolids(int shell_id, const std::vector<int>& part_of_piece,
                                  const std::vector<Vector3<double>>& design) {
  Shell& shell = shells_[shell_id];
  const std::size_t count = design.size();
  for (std::size_t v = mesh_.vertices.size(); v < count; ++v)
    body_of_.push_back(body_of_[change_.split_from[v - change_.first_new_vertex]]);
  mesh_.vertices.resize(count);
  velocities_.resize(count, Vector3<double>::Zero());
  inverse_masses_.resize(count, 0);
  is_movable_.resize(count, 1);
  held_with_.resize(count, -1);
  pinned_to_.resize(count, -1);
  solid_of_.resize(count, -1);
  rest_.resize(count, Vector3<double>::Zero());

  struct Part {
    int old;
    Solid solid;
  };
  std::vector<Part> parts;
  const auto vertices_of = shell.surface.verticesOf(part_of_piece);
  std::vector<int> part_index(vertices_of.size(), -1);
  for (std::size_t part = 0; part < vertices_of.size(); ++part) {
    int pieces = 0;
    int old = -1;
    for (std::size_t piece = 0; piece < part_of_piece.size(); ++piece)
      if (part_of_piece[piece] == static_cast<int>(part)) {
        ++pieces;
        old = shell.solid_of_piece[piece];
      }
    const Solid& whole = solids_[old];
    if (whole.pieces == pieces) continue;  // no piece was separated
    SolidOptions options;
    options.frequency = whole.body.frequency;
    Solid solid = makeSolid(vertices_of[part], design, shell.vertex_mass, options);
    solid.shell = shell_id;
    solid.pieces = pieces;
    const Vector3<double> from_whole = solid.offset - whole.offset;
    const auto carried = [&](const AffineState& state) {
      return AffineState{state.centre + state.shape * from_whole, state.shape};
    };
    solid.body.begin = solid.body.end = carried(whole.body.begin);
    solid.body.velocity = carried(whole.body.velocity);
    if (from_whole.norm() > 0)
      solid.body.velocity.centre +=
          shell.options.burst * random_.uniform(0.3, 1) *
          (whole.body.begin.shape * (solid.offset - shell.middle)).normalized();
    part_index[part] = static_cast<int>(parts.size());
    parts.push_back({old, std::move(solid)});
  }

  // The first part of a body replaces it, the others are added at the end.
  std::vector<int> id_of_part;
  std::vector<char> is_taken(solids_.size(), 0);
  for (Part& part : parts) {
    int id = part.old;
    if (is_taken[id]) {
      id = static_cast<int>(solids_.size());
      solids_.push_back({});
    } else {
      is_taken[id] = 1;
    }
    id_of_part.push_back(id);
    for (const int v : part.solid.body.vertices) {
      solid_of_[v] = id;
      mesh_.vertices[v] =
          part.solid.body.begin.centre + part.solid.body.begin.shape * rest_[v];
    }
    solids_[id] = std::move(part.solid);
  }
  for (std::size_t piece = 0; piece < part_of_piece.size(); ++piece) {
    const int part = part_index[part_of_piece[piece]];
    if (part >= 0) shell.solid_of_piece[piece] = id_of_part[part];
  }
}

}  // namespace test
}  // namespace fcl

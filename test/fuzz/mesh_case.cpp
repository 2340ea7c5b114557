// SPDX-License-Identifier: BSD-3-Clause
#include "mesh_case.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "fcl/narrowphase/continuous_contact_kind.h"
#include "minimise.h"

namespace fcl {
namespace test {
namespace {

using Vec = Vector3<double>;

template <typename Visit>
void forEachFrame(MovingMesh& mesh, Visit&& visit) {
  for (auto* frame : {&mesh.t0, &mesh.t1}) visit(*frame);
}

MovingMesh closedBody(Random& random, std::size_t most_triangles, double step) {
  const double radius = random.uniform(0.2, 0.7);
  const TestMesh body =
      most_triangles < 80 ? makeBox(Vec::Constant(radius)) : makeIcosphere(1, radius);
  MovingMesh mesh = still(body);
  const Vec place = random.point(0.4), way = random.point(step);
  for (std::size_t i = 0; i < mesh.t0.size(); ++i) {
    mesh.t0[i] += place + random.point(0.1 * radius);
    mesh.t1[i] = mesh.t0[i] + way + random.point(0.2 * step);
  }
  return mesh;
}

/// Collapsed and repeated triangles, in which corners may change places.
void addDegenerate(Random& random, MovingMesh& mesh) {
  const std::size_t count = mesh.triangles.size();
  for (std::size_t n = 1 + count / 8; n > 0; --n) {
    const Triangle t = mesh.triangles[random.index(count)];
    if (random.index(2))
      mesh.triangles.emplace_back(t[2], t[0], t[1]);
    else
      mesh.triangles.emplace_back(t[0], t[1], t[random.index(2) ? 0 : 1]);
  }
}

/// Vertices of different ids at one place, in one frame or in both.
void joinVertices(Random& random, MovingMesh& mesh) {
  const std::size_t frames = 1 + random.index(3);
  for (std::size_t n = 1 + mesh.t0.size() / 6; n > 0; --n) {
    const std::size_t from = random.index(mesh.t0.size()),
                      to = random.index(mesh.t0.size());
    if (frames & 1) mesh.t0[to] = Vec(mesh.t0[from]);
    if (frames & 2) mesh.t1[to] = Vec(mesh.t1[from]);
  }
}

/// Some coordinates do not change, or are the same for all.
void flatten(Random& random, MovingMesh& mesh) {
  const int axis = static_cast<int>(random.index(3));
  const std::size_t how = random.index(4);
  const double level = how == 2 ? 0 : 0.25;
  for (std::size_t i = 0; i < mesh.t0.size(); ++i) {
    if (how == 0) mesh.t1[i][axis] = mesh.t0[i][axis];
    if (how == 1) mesh.t1[i] = mesh.t0[i] + Vec(0.25, -0.5, 0.125);
    if (how >= 2) mesh.t0[i][axis] = level;
    if (how == 3) mesh.t1[i][axis] = level;
  }
}

void putOnGrid(MovingMesh& mesh, double spacing) {
  forEachFrame(mesh, [spacing](std::vector<Vec>& frame) {
    for (Vec& p : frame)
      for (int k = 0; k < 3; ++k) p[k] = std::round(p[k] / spacing) * spacing;
  });
}

void dropUnusedVertices(MovingMesh& mesh) {
  std::vector<std::size_t> id(mesh.t0.size(), mesh.t0.size());
  MovingMesh out;
  for (const Triangle& t : mesh.triangles) {
    std::size_t corner[3];
    for (int k = 0; k < 3; ++k) {
      std::size_t& to = id[t[k]];
      if (to == mesh.t0.size()) {
        to = out.t0.size();
        out.t0.push_back(mesh.t0[t[k]]);
        out.t1.push_back(mesh.t1[t[k]]);
      }
      corner[k] = to;
    }
    out.triangles.emplace_back(corner[0], corner[1], corner[2]);
  }
  mesh = std::move(out);
}

}  // namespace

MovingMesh randomFuzzMesh(Random& random, std::size_t most_triangles) {
  // Short steps are as usual as long ones.
  const double step = random.index(8) ? std::pow(10, random.uniform(-3, 0.3)) : 0;
  const std::size_t count = 4 + random.index(most_triangles - 3);
  MovingMesh mesh;
  switch (random.index(4)) {
    case 0:
      mesh = crumpledSheet(
          random,
          std::max(1, static_cast<int>(std::sqrt(static_cast<double>(count) / 2))), step);
      break;
    case 1:
      mesh = closedBody(random, most_triangles, step);
      break;
    default:
      // Few vertices have many triangles in common.
      mesh = randomSoup(random, count, 3 + random.index(2 * count), 0.6, step);
  }
  if (random.index(3) == 0) joinVertices(random, mesh);
  if (random.index(4) == 0) flatten(random, mesh);
  if (random.index(3) == 0) addDegenerate(random, mesh);
  return mesh;
}

MeshCase randomMeshCase(Random& random) {
  constexpr std::size_t kMost[] = {6,  6,  8,  8,  12, 12, 12,  16,
                                   16, 24, 24, 32, 32, 48, 100, 200};
  const std::size_t most = kMost[random.index(16)];
  MeshCase out;
  out.a = randomFuzzMesh(random, most);
  if (random.index(2)) out.b = randomFuzzMesh(random, most);
  constexpr double kSpacings[] = {0x1p-1, 0x1p-2, 0x1p-3, 0x1p-6, 0x1p-12};
  out.is_on_grid = random.index(3) != 0;
  if (out.is_on_grid) {
    const double spacing = kSpacings[random.index(5)];
    putOnGrid(out.a, spacing);
    if (out.b) putOnGrid(*out.b, spacing);
  }
  if (random.index(4) == 0) {
    out.min_distance = std::pow(10, random.uniform(-4, -0.5));
    out.ignores_initially_closer = random.index(2) == 0;
  }
  if (random.index(4) == 0)
    out.t_max =
        random.index(2) ? static_cast<double>(random.index(5)) / 4 : random.uniform(0, 1);
  return out;
}

namespace {

/// Unused ones, -1, go last.
template <std::size_t kSize>
void sortIds(std::array<int, kSize>& ids) {
  for (std::size_t i = 0; i < kSize; ++i)
    for (std::size_t j = i + 1; j < kSize; ++j)
      if (static_cast<unsigned>(ids[j]) < static_cast<unsigned>(ids[i]))
        std::swap(ids[i], ids[j]);
}

}  // namespace

ContactId contactId(int kind, bool first_on_o1, bool is_self, std::array<int, 2> first,
                    std::array<int, 3> second) {
  const auto num = [](const auto& ids) {
    return std::find(ids.begin(), ids.end(), -1) - ids.begin();
  };
  sortIds(first);
  sortIds(second);
  if (is_self) {
    first_on_o1 = true;
    const std::array<int, 2> other{second[0], second[1]};
    if (num(first) == num(second) && other < first) {
      second = {first[0], first[1], -1};
      first = other;
    }
  }
  return {kind, first_on_o1, first[0], first[1], second[0], second[1], second[2]};
}

std::string nameOf(const ContactId& id) {
  std::ostringstream out;
  out << "kind " << id[0] << (id[1] ? "" : ", first feature of o2") << ":";
  for (std::size_t i = 2; i < id.size(); ++i)
    if (id[i] >= 0) out << (i == 4 ? " and " : " ") << id[i];
  return out.str();
}

void minimise(MeshCase& mesh_case, const std::function<bool(const MeshCase&)>& fails) {
  const auto still_fails = [&] {
    return !mesh_case.a.triangles.empty() &&
           (!mesh_case.b || !mesh_case.b->triangles.empty()) && fails(mesh_case);
  };
  minimise(mesh_case.a.triangles, still_fails);
  if (mesh_case.b) minimise(mesh_case.b->triangles, still_fails);
  const MeshCase before = mesh_case;
  dropUnusedVertices(mesh_case.a);
  if (mesh_case.b) dropUnusedVertices(*mesh_case.b);
  if (!fails(mesh_case)) mesh_case = before;
}

std::string asCode(const MovingMesh& mesh, const std::string& name) {
  std::ostringstream out;
  out << "  const MovingMesh " << name << "{\n" << std::hexfloat;
  for (const auto* frame : {&mesh.t0, &mesh.t1}) {
    out << "      {";
    for (const Vec& p : *frame)
      out << "{" << p[0] << ", " << p[1] << ", " << p[2] << "}, ";
    out << "},\n";
  }
  out << "      {";
  for (const Triangle& t : mesh.triangles)
    out << "Triangle(" << t[0] << ", " << t[1] << ", " << t[2] << "), ";
  out << "}};\n";
  return out.str();
}

std::string asTest(const MeshCase& mesh_case, const std::string& expected) {
  std::ostringstream out;
  out << "  // test/unit/test_fcl_min_distance.cpp\n" << asCode(mesh_case.a, "a");
  if (mesh_case.b) out << asCode(*mesh_case.b, "b");
  out << std::hexfloat << "  Request request;\n  request.toc_err = " << mesh_case.toc_err
      << ";\n  request.min_distance = " << mesh_case.min_distance
      << ";\n  request.ignore_initially_closer = " << std::boolalpha
      << mesh_case.ignores_initially_closer << ";\n  request.t_max = " << mesh_case.t_max
      << ";\n  const Result result = "
      << (mesh_case.b ? "pairContacts<double>(*modelOf(a), *modelOf(b), request);\n"
                      : "selfContacts<double>(*modelOf(a), request);\n")
      << expected;
  return out.str();
}

}  // namespace test
}  // namespace fcl

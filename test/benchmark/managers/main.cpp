// SPDX-License-Identifier: BSD-3-Clause
//
//   fcl_ccd_managers [LARGEST [boxes]] > managers.csv
//
// Speed and errors of the continuous manager on 100 to LARGEST (100,000) objects at equal
// density; with "boxes", of the broad phase alone. doc/broad_phase.md explains the
// columns.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "fcl/broadphase/continuous_collision_manager.h"
#include "fcl/geometry/shape/box.h"
#include "fcl/geometry/shape/sphere.h"
#include "fcl/math/bv/OBBRSS.h"
#include "machine.h"
#include "mesh_generators.h"
#include "moving_objects.h"

namespace {

using namespace fcl::test;
using Object = fcl::ContinuousCollisionObject<double>;
using Manager = fcl::ContinuousCollisionManager<double>;
using Geometry = std::shared_ptr<fcl::CollisionGeometry<double>>;
using Motion = fcl::MotionBase<double>;
using Vector = fcl::Vector3<double>;
using ObjectPair = std::pair<Object*, Object*>;

constexpr double kRadius = .5;

/// Processor time of this thread in milliseconds: other programs count less.
double now() {
  timespec time;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return 1e3 * double(time.tv_sec) + 1e-6 * double(time.tv_nsec);
}

template <typename Work>
double timeOf(Work&& work) {
  const double start = now();
  work();
  return now() - start;
}

double median(std::vector<double> times) {
  const auto half = times.begin() + static_cast<std::ptrdiff_t>(times.size() / 2);
  std::nth_element(times.begin(), half, times.end());
  return *half;
}

template <typename Work>
double medianOf(int runs, Work&& work) {
  std::vector<double> times;
  for (int i = 0; i < runs; ++i) times.push_back(timeOf(work));
  return median(times);
}

/// A kind of scene.
struct Kind {
  const char* name;
  bool has_shapes, turns;
  /// One object of this number moves.
  std::size_t one_moves_of;
  /// The edge of the cube that an object has for itself.
  double spacing;
};

constexpr Kind kKinds[] = {{"meshes", false, false, 1, 1.55},
                           {"meshes_turning", false, true, 1, 1.55},
                           {"boxes_spheres_meshes", true, false, 1, 1.55},
                           {"one_of_101_moves", true, false, 101, 1.55}};

Geometry makeMesh() {
  const TestMesh mesh = makeUvSphere(10, 6, kRadius);  // 100 triangles
  auto model = std::make_shared<fcl::BVHModel<fcl::OBBRSS<double>>>();
  model->beginModel();
  model->addSubModel(mesh.vertices, mesh.triangles);
  model->endModel();
  return model;
}

struct Scene {
  std::vector<std::unique_ptr<Object>> owned;
  std::vector<Object*> objects, moving;
  std::vector<Vector> homes, ends;  ///< of those that move: near it, at the step's end
  std::vector<std::array<double, 6>> sweeps;  ///< a box that contains the object
  std::vector<Geometry> geometries;
};

std::shared_ptr<Motion> makeMotion(const Vector& from, const Vector& to, bool turns,
                                   Random& random) {
  if (!turns) return translation(from, to);
  const fcl::AngleAxis<double> turn(1, randomDirection(random));
  return std::make_shared<fcl::InterpMotion<double>>(fcl::Matrix3<double>::Identity(),
                                                     from, turn.toRotationMatrix(), to,
                                                     Vector(0, 0, 0));
}

/// Objects that rest are on a grid, so that none touch.
Vector placeOf(const Kind& kind, std::size_t i, std::size_t count, bool moves,
               Random& random) {
  const double edge = kind.spacing * std::cbrt(double(count));
  if (moves) return random.point(edge / 2);
  const auto side = static_cast<std::size_t>(std::ceil(std::cbrt(double(count))));
  const Vector cell(double(i % side), double(i / side % side), double(i / side / side));
  return kind.spacing * cell - Vector::Constant(edge / 2);
}

Scene makeScene(const Kind& kind, std::size_t count) {
  Random random(count);
  Scene scene;
  for (std::size_t i = 0; i < count; ++i) {
    // A geometry for 8 objects.
    if (i % 8 == 0) {
      const std::size_t form = kind.has_shapes ? i / 8 % 3 : 0;
      if (form == 0) scene.geometries.push_back(makeMesh());
      if (form == 1)
        scene.geometries.push_back(std::make_shared<fcl::Sphere<double>>(kRadius));
      if (form == 2)
        scene.geometries.push_back(std::make_shared<fcl::Box<double>>(.6, .6, .6));
    }
    const bool moves = i % kind.one_moves_of == 0;
    const Vector from = placeOf(kind, i, count, moves, random),
                 to = moves ? Vector(from + random.point(.4)) : from;
    scene.owned.push_back(makeObject(scene.geometries.back(),
                                     makeMotion(from, to, moves && kind.turns, random)));
    scene.objects.push_back(scene.owned.back().get());
    if (moves) {
      scene.moving.push_back(scene.objects.back());
      scene.homes.push_back(from);
      scene.ends.push_back(to);
    }
    // Meshes turn about their center.
    const double r = kRadius * 1.1;
    std::array<double, 6> sweep;
    for (int k = 0; k < 3; ++k) {
      sweep[static_cast<std::size_t>(k)] = std::min(from[k], to[k]) - r;
      sweep[static_cast<std::size_t>(k + 3)] = std::max(from[k], to[k]) + r;
    }
    scene.sweeps.push_back(sweep);
  }
  return scene;
}

/// The next step of the objects that move: each goes to another place near its home, so
/// that the density stays. If a scene of 1,000 objects is repeated, the processor learns
/// its branches, and needs half of the time.
void makeNextStep(const Kind& kind, Random& random, Scene& scene) {
  for (std::size_t i = 0; i < scene.moving.size(); ++i) {
    const Vector from = scene.ends[i], to = scene.homes[i] + random.point(.3);
    scene.ends[i] = to;
    const std::shared_ptr<Motion> next = makeMotion(from, to, kind.turns, random);
    Motion& motion = *scene.moving[i]->getMotion();
    if (kind.turns)
      static_cast<fcl::InterpMotion<double>&>(motion) =
          static_cast<const fcl::InterpMotion<double>&>(*next);
    else
      static_cast<fcl::TranslationMotion<double>&>(motion) =
          static_cast<const fcl::TranslationMotion<double>&>(*next);
  }
}

bool isInContact(const Object* o1, const Object* o2) {
  fcl::ContinuousContactRequest<double> request;
  request.query = fcl::ContinuousQuery::kFirst;
  request.enable_contact = false;
  fcl::ContinuousContactResult<double> result;
  fcl::collide(o1, o2, request, result);
  return result.is_collide;
}

/// The pairs in contact, found by sorting the sweeps along x.
std::set<ObjectPair> sortedPairsInContact(const Scene& scene) {
  std::vector<std::size_t> order(scene.objects.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return scene.sweeps[a][0] < scene.sweeps[b][0];
  });
  std::set<ObjectPair> out;
  for (std::size_t i = 0; i < order.size(); ++i)
    for (std::size_t k = i + 1; k < order.size(); ++k) {
      const auto &a = scene.sweeps[order[i]], &b = scene.sweeps[order[k]];
      if (b[0] > a[3]) break;
      if (b[1] > a[4] || a[1] > b[4] || b[2] > a[5] || a[2] > b[5]) continue;
      Object *one = scene.objects[std::min(order[i], order[k])],
             *two = scene.objects[std::max(order[i], order[k])];
      if (isInContact(one, two)) out.emplace(one, two);
    }
  return out;
}

bool collect(Object* o1, Object* o2, void* pairs) {
  static_cast<std::vector<ObjectPair>*>(pairs)->emplace_back(o1, o2);
  return false;
}

bool collectContact(Object* o1, Object* o2, void* pairs) {
  if (isInContact(o1, o2)) collect(o1, o2, pairs);
  return false;
}

/// The queries of pairs take minutes: without them a run takes seconds.
struct PairTimes {
  double alone{0}, within{0};
  std::size_t contacts{0};
  std::ptrdiff_t missed{0}, extra{0};
};

PairTimes measurePairs(const Scene& scene, const Manager& manager,
                       const std::vector<ObjectPair>& box_pairs) {
  PairTimes out;
  const std::size_t count = scene.objects.size();
  const int runs = count > 2000 ? 1 : count > 200 ? 3 : 15;
  std::vector<ObjectPair> contacts;
  out.within = medianOf(runs, [&] {
    contacts.clear();
    manager.collide(&contacts, &collectContact);
  });
  std::size_t meet = 0;
  out.alone = medianOf(runs, [&] {
    meet = 0;
    for (const ObjectPair& pair : box_pairs) meet += isInContact(pair.first, pair.second);
  });
  const std::set<ObjectPair> truth = sortedPairsInContact(scene),
                             found(contacts.begin(), contacts.end());
  const auto lacking = [](const std::set<ObjectPair>& from,
                          const std::set<ObjectPair>& in) {
    return std::count_if(from.begin(), from.end(),
                         [&](const ObjectPair& pair) { return !in.count(pair); });
  };
  out.contacts = contacts.size();
  out.missed = lacking(truth, found);
  out.extra = lacking(found, truth);
  return out;
}

void measure(const Kind& kind, std::size_t count, bool with_pairs) {
  Scene scene = makeScene(kind, count);
  Manager manager;
  const double insert = timeOf([&] { manager.registerObjects(scene.objects); });
  std::vector<ObjectPair> box_pairs, found;
  manager.collide(&box_pairs, &collect);  // remembers the pairs that rest
  PairTimes pairs;
  if (with_pairs) pairs = measurePairs(scene, manager, box_pairs);
  Random random(count + 1);
  std::vector<double> updates, queries;
  for (int run = 0; run < 15; ++run) {
    makeNextStep(kind, random, scene);
    updates.push_back(timeOf([&] { manager.update(scene.moving); }));
    found.clear();
    queries.push_back(timeOf([&] { manager.collide(&found, &collect); }));
  }
  const double update = median(updates), query = median(queries);
  std::printf("%s,%zu,%zu,%.3f,%.3f,%.3f,%.4f,%zu,%.2f,%.2f,%zu,%td,%td\n", kind.name,
              count, scene.moving.size(), insert, update, query,
              1e3 * (update + query) / double(scene.moving.size()), box_pairs.size(),
              pairs.alone, pairs.within, pairs.contacts, pairs.missed, pairs.extra);
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  const long largest = argc > 1 ? std::atol(argv[1]) : 100000;
  const bool with_pairs = argc <= 2 || std::string(argv[2]) != "boxes";
  std::printf(
      "kind,objects,moving,insert_ms,update_ms,query_ms,us_per_moving,box_pairs,"
      "pair_queries_ms,query_with_pairs_ms,contacts,missed,extra\n");
  for (const Kind& kind : kKinds)
    for (std::size_t count = 100; count <= static_cast<std::size_t>(largest); count *= 10)
      measure(kind, kind.one_moves_of == 1 ? count : count + count / 100, with_pairs);
  std::fprintf(stderr, "%s\n", machineName().c_str());
  return 0;
}

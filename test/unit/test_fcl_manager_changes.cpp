// SPDX-License-Identifier: BSD-3-Clause
//
// What a manager's objects were read from, and whether that has changed since; and what
// has changed from one answer of a manager to the next.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "fcl/broadphase/collision_robot.h"
#include "fcl/broadphase/continuous_collision_manager.h"
#include "fcl/geometry/bvh/deformable_bvh_model.h"
#include "fcl/geometry/compound_geometry.h"
#include "fcl/geometry/shape/sphere.h"
#include "manager_scenes.h"
#include "moving_objects.h"
#include "sanitizer.h"
#include "test_models.h"

namespace fcl {
namespace test {
namespace {

using Manager = ContinuousCollisionManager<double>;
using Object = ContinuousCollisionObject<double>;
using Request = ContinuousContactRequest<double>;
using Result = ContinuousManagerResult<double>;
using Model = DeformableBVHModel<KDOP<double, 16>>;
using V = Vector3<double>;

/// Sheets above each other, far apart.
struct Sheets {
  std::vector<std::shared_ptr<Model>> models;
  std::vector<std::unique_ptr<Object>> objects;
  Manager manager;

  explicit Sheets(std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
      models.push_back(makeModel<Model>(sheet(i)));
      objects.push_back(makeObject(models[i], translation(V::Zero(), V::Zero())));
      manager.registerObject(objects[i].get());
    }
  }
  static TestMesh sheet(std::size_t i, double up = 0) {
    return bentSheet(3, 10 * double(i) + up);
  }
  std::string error() const {
    return errorOf([this] {
      Result result;
      manager.collide(Request(), result);
    });
  }
};

/// All queries of a manager.
std::vector<std::function<void()>> queriesOf(Manager& manager, const Manager& other,
                                             Object* object) {
  const auto none = [](Object*, Object*, void*) { return false; };
  return {[&manager] {
            Result result;
            manager.collide(Request(), result);
          },
          [&manager, object] {
            Result result;
            manager.collide(object, Request(), result);
          },
          [&manager, &other] {
            Result result;
            manager.collide(other, Request(), result);
          },
          [&manager, &other] {
            Result result;
            other.collide(manager, Request(), result);
          },
          [&manager] {
            manager.collide(Request(),
                            [](ContinuousPairResult<double>&) { return false; });
          },
          [&manager, none] { manager.collide(nullptr, none); },
          [&manager, object, none] { manager.collide(object, nullptr, none); },
          [&manager, &other, none] { manager.collide(other, nullptr, none); },
          [&manager] {
            ContinuousManagerDistance<double> nearest;
            manager.distance(ContinuousDistanceRequest<double>(), nearest);
          },
          [&manager, object] {
            ContinuousManagerDistance<double> nearest;
            manager.distance(object, ContinuousDistanceRequest<double>(), nearest);
          },
          [&manager, &other] {
            ContinuousManagerDistance<double> nearest;
            manager.distance(other, ContinuousDistanceRequest<double>(), nearest);
          },
          [&manager] {
            DefaultContinuousDistanceData<double> data;
            manager.distance(&data, &DefaultContinuousDistanceFunction<double>);
          }};
}

TEST(FCL_MANAGER_CHANGES, EveryQueryNoticesAForgottenUpdate) {
  Sheets scene(3), others(1);
  EXPECT_EQ(update(*scene.models[2], Sheets::sheet(2, .5)), BVH_OK);
  for (const auto& query :
       queriesOf(scene.manager, others.manager, scene.objects[0].get()))
    expectRefused(query, "object 2: its mesh was changed after");
  scene.manager.update({scene.objects[0].get(), scene.objects[1].get()});
  EXPECT_NE(scene.error(), "");
  scene.manager.update(scene.objects[2].get());
  for (const auto& query :
       queriesOf(scene.manager, others.manager, scene.objects[0].get()))
    EXPECT_EQ(errorOf(query), "");
}

TEST(FCL_MANAGER_CHANGES, AnObjectThatIsReadNowNeedsNoUpdate) {
  Sheets scene(2);
  EXPECT_EQ(update(*scene.models[1], Sheets::sheet(1, -10)), BVH_OK);
  Result result;
  scene.manager.collide(scene.objects[1].get(), Request(), result);
  EXPECT_EQ(result.num_box_pairs, 1u);
  expectRefused([&] { scene.manager.collide(scene.objects[0].get(), Request(), result); },
                "object 1");
}

TEST(FCL_MANAGER_CHANGES, EveryChangeOfAModelIsNoticed) {
  const TestMesh first = Sheets::sheet(0), second = Sheets::sheet(0, .1);
  const auto frame = [](const TestMesh& mesh) { return mesh.vertices[0].data(); };
  const std::vector<std::function<void(Model&)>> changes = {
      [&](Model& m) { EXPECT_EQ(update(m, second), BVH_OK); },
      [&](Model& m) {
        EXPECT_EQ(m.updateFrames(frame(first), frame(second), first.vertices.size()),
                  BVH_OK);
      },
      [&](Model& m) {
        EXPECT_EQ(m.updateTopology(first.triangles, std::vector<int>(), frame(first),
                                   frame(second), first.vertices.size()),
                  BVH_OK);
      },
      [&](Model& m) {
        EXPECT_EQ(m.beginReplaceModel(), BVH_OK);
        EXPECT_EQ(m.replaceSubModel(second.vertices), BVH_OK);
        EXPECT_EQ(m.endReplaceModel(), BVH_OK);
      },
      [&](Model& m) { m = Model(*makeModel<Model>(second)); }};
  for (std::size_t i = 0; i < changes.size(); ++i) {
    SCOPED_TRACE(i);
    Sheets scene(2);
    EXPECT_EQ(scene.error(), "");
    changes[i](*scene.models[0]);
    expectMessage(scene.error(), "object 0");
    scene.manager.update();
    EXPECT_EQ(scene.error(), "");
  }
}

TEST(FCL_MANAGER_CHANGES, WhatChangesNoFrameIsNoChange) {
  Sheets scene(2);
  EXPECT_EQ(update(*scene.models[0], Sheets::sheet(0, .1)), BVH_OK);
  scene.manager.update();
  EXPECT_EQ(scene.models[0]->updateFclTree(), BVH_OK);
  scene.models[0]->computeLocalAABB();
  Model copy(*scene.models[0]);
  EXPECT_EQ(update(copy, Sheets::sheet(0, .2)), BVH_OK);
  EXPECT_NE(scene.models[0]->updateFrames(nullptr, nullptr, 16), BVH_OK);
  EXPECT_EQ(scene.error(), "");
}

TEST(FCL_MANAGER_CHANGES, EachObjectOfAModelIsReadAgain) {
  Sheets scene(1);
  const auto second = makeObject(scene.models[0], translation(V(0, 0, 5), V(0, 0, 5)));
  scene.manager.registerObject(second.get());
  EXPECT_EQ(update(*scene.models[0], Sheets::sheet(0, .1)), BVH_OK);
  scene.manager.update(scene.objects[0].get());
  expectMessage(scene.error(), "object 1");
  scene.manager.update(second.get());
  EXPECT_EQ(scene.error(), "");
  // An object may get another geometry, if it is read then.
  EXPECT_EQ(update(*scene.models[0], Sheets::sheet(0, .2)), BVH_OK);
  scene.manager.unregisterObject(second.get());
  scene.objects[0]->~Object();
  new (scene.objects[0].get())
      Object(std::make_shared<Sphere<double>>(1), translation(V::Zero(), V::Zero()));
  scene.models.clear();
  scene.manager.update();
  EXPECT_EQ(scene.error(), "");
}

TEST(FCL_MANAGER_CHANGES, RandomSequences) {
  Random random(5);
  int num_noticed = 0;
  for (int round = 0; round < rounds(50); ++round) {
    Sheets scene(8);
    Manager& manager = scene.manager;
    std::vector<Object*> registered;
    std::set<const Object*> stale;
    for (const auto& object : scene.objects) registered.push_back(object.get());
    for (int step = 0; step < 60; ++step) {
      const std::size_t i = random.index(scene.objects.size());
      Object* const object = scene.objects[i].get();
      const auto place = std::find(registered.begin(), registered.end(), object);
      switch (random.index(4)) {
        case 0:
          ASSERT_EQ(update(*scene.models[i], Sheets::sheet(i, random.uniform(0, 1))),
                    BVH_OK);
          if (place != registered.end()) stale.insert(object);
          break;
        case 1:
          if (place == registered.end()) {
            manager.registerObject(object);
            registered.push_back(object);
          } else {
            manager.unregisterObject(object);
            registered.erase(place);
            stale.erase(object);
          }
          break;
        default:
          if (place == registered.end()) break;
          manager.update(object);
          stale.erase(object);
      }
      const std::string error = scene.error();
      ASSERT_EQ(error.empty(), stale.empty()) << error;
      if (error.empty()) continue;
      ++num_noticed;
      ASSERT_TRUE(std::any_of(stale.begin(), stale.end(), [&](const Object* one) {
        const auto at = std::find(registered.begin(), registered.end(), one);
        return error.find("object " + std::to_string(at - registered.begin()) + ":") == 0;
      })) << error;
    }
  }
  EXPECT_GT(num_noticed, rounds(50) * 10);
}

TEST(FCL_MANAGER_CHANGES, ARobotNoticesForgottenUpdates) {
  Sheets obstacles(1);
  JointChain chain;
  const int link = chain.addRevolute(Transform3<double>::Identity(), V::UnitZ());
  CollisionRobot<double> robot(chain);
  const auto model = makeModel<Model>(Sheets::sheet(4));
  robot.attach(link, model);
  const auto ask = [&] {
    RobotEdgeResult<double> result;
    robot.checkEdge({0}, {1}, &obstacles.manager, Request(), result);
  };
  EXPECT_EQ(errorOf(ask), "");
  EXPECT_EQ(update(*model, Sheets::sheet(4, 0)), BVH_OK);
  expectRefused(ask, "has a mesh that was changed after the robot had read it");
  robot.update();
  EXPECT_EQ(errorOf(ask), "");
  EXPECT_EQ(update(*obstacles.models[0], Sheets::sheet(0, 1)), BVH_OK);
  expectRefused(ask, "object 0: its mesh was changed");
  obstacles.manager.update();
  EXPECT_EQ(errorOf(ask), "");
}

TEST(FCL_MANAGER_CHANGES, ACompoundNoticesForgottenUpdates) {
  const auto model = makeModel<Model>(Sheets::sheet(0));
  const auto compound = std::make_shared<CompoundGeometry<double>>();
  compound->addPart(model);
  compound->addPart(std::make_shared<Sphere<double>>(1));
  const auto ball = std::make_shared<Sphere<double>>(1);
  const auto one = makeObject(compound, translation(V::Zero(), V::Zero())),
             two = makeObject(ball, translation(V(0, 0, 5), V(0, 0, 0)));
  const auto ask = [&] {
    ContinuousContactResult<double> result;
    fcl::collide(one.get(), two.get(), Request(), result);
    EXPECT_TRUE(result.is_collide);
  };
  EXPECT_EQ(errorOf(ask), "");
  const TestMesh higher = Sheets::sheet(0, 1);
  EXPECT_EQ(model->updateFrames(higher.vertices[0].data(), higher.vertices[0].data(),
                                higher.vertices.size()),
            BVH_OK);
  expectRefused(ask, "part 0 of a CompoundGeometry, o1, is a mesh that was changed");
  compound->update();
  EXPECT_EQ(errorOf(ask), "");
}

/// Also where no box meets that of the compound; and if only one of the two is told.
TEST(FCL_MANAGER_CHANGES, AManagerNoticesChangesOfPartsOfCompounds) {
  constexpr int kParts = 3;
  Random random(8);
  for (int round = 0; round < rounds(30); ++round) {
    Sheets scene(2);
    std::vector<std::shared_ptr<Model>> models;
    std::vector<std::shared_ptr<CompoundGeometry<double>>> compounds;
    std::vector<std::unique_ptr<Object>> objects;
    JointChain chain;
    chain.addRevolute(Transform3<double>::Identity(), V::UnitZ());
    CollisionRobot<double> robot(chain);
    for (int k = 0; k < 3; ++k) {
      compounds.push_back(std::make_shared<CompoundGeometry<double>>());
      for (int i = 0; i < kParts; ++i) {
        models.push_back(makeModel<Model>(Sheets::sheet(std::size_t(5 + k))));
        compounds[k]->addPart(models.back());
      }
      compounds[k]->addPart(std::make_shared<Sphere<double>>(.1));
      objects.push_back(makeObject(compounds[k], translation(V::Zero(), V::Zero())));
      scene.manager.registerObject(objects[k].get());
    }
    robot.attach(0, compounds[0]);
    const auto edge = [&] {
      RobotEdgeResult<double> result;
      robot.checkEdge({0}, {.1}, nullptr, Request(), result);
    };
    EXPECT_EQ(scene.error(), "");
    EXPECT_EQ(errorOf(edge), "");
    if (random.index(2) == 0) {
      // Its sources go, and those of others stay.
      scene.manager.unregisterObject(objects[1].get());
      scene.manager.registerObject(objects[1].get());
    }
    const std::size_t changed = random.index(3), part = random.index(kParts);
    const TestMesh other = Sheets::sheet(5 + changed, .1);
    const double* frame = other.vertices[0].data();
    ASSERT_EQ(models[changed * kParts + part]->updateFrames(frame, frame,
                                                            other.vertices.size()),
              BVH_OK);
    std::vector<Object*> in_order;
    scene.manager.getObjects(in_order);
    const auto place =
        std::find(in_order.begin(), in_order.end(), objects[changed].get());
    const std::string name =
        "object " + std::to_string(place - in_order.begin()) + ": its mesh was changed";
    expectMessage(scene.error(), name);
    EXPECT_EQ(errorOf(edge).empty(), changed != 0);
    compounds[changed]->update();
    expectMessage(scene.error(), name);
    scene.manager.update(objects[changed].get());
    EXPECT_EQ(scene.error(), "");
    robot.update();
    EXPECT_EQ(errorOf(edge), "");
  }
}

/// A contact by what makes it the same in the next step, without the library's keys.
std::string nameOf(const ContinuousContact<double>& c) {
  std::vector<std::string> sides;
  const auto ids = [&c](int first, int count) {
    std::multiset<int> sorted(c.vertices.begin() + first,
                              c.vertices.begin() + first + count);
    std::string text;
    for (const int id : sorted) text += std::to_string(id) + " ";
    return text;
  };
  std::string name = "parts " + std::to_string(c.part1) + " " + std::to_string(c.part2);
  switch (c.kind) {
    case ContinuousContactKind::kVertexFace:
      return name + " VF" + std::to_string(c.first_on_o1) + " " + ids(0, 1) + "|" +
             ids(1, 3);
    case ContinuousContactKind::kEdgeEdge:
      return name + " EE " + ids(0, 2) + "|" + ids(2, 2);
    case ContinuousContactKind::kVertexEdge:
      return name + " VE" + std::to_string(c.first_on_o1) + " " + ids(0, 1) + "|" +
             ids(1, 2);
    case ContinuousContactKind::kVertexVertex:
      return name + " VV " + ids(0, 1) + "|" + ids(1, 1);
    case ContinuousContactKind::kCrossing:
      return name + " C" + std::to_string(c.first_on_o1) + " " + ids(0, 2) + "|" +
             ids(2, 3);
    default:
      return name + " S " + std::to_string(c.b1) + " " + std::to_string(c.b2);
  }
}

TEST(FCL_PERSISTENT_PAIRS, RandomScenesAgainstNames) {
  Random random(17);
  std::size_t num_added = 0, num_kept = 0, num_removed = 0, num_same = 0, num_new = 0;
  for (int round = 0; round < rounds(20); ++round) {
    ManagerScene scene(random, 30);
    PersistentPairs<double, std::vector<std::uint64_t>> tracked;
    using Key = std::pair<const Object*, const Object*>;
    struct Known {
      std::uint64_t id;
      std::size_t num_steps;
      std::map<std::string, std::ptrdiff_t> contacts;
    };
    std::map<Key, Known> before;
    std::set<std::uint64_t> ids;
    for (int step = 0; step < 6; ++step) {
      if (step > 0) {
        // Objects that go are deleted only with the scene.
        scene.change();
      }
      Request request;
      request.min_distance = round % 3 == 0 ? .05 : 0;
      Result result;
      scene.manager.collide(request, result);
      tracked.update(result);
      std::map<Key, Known> now;
      std::size_t num_gone = before.size();
      ASSERT_EQ(tracked.pairs().size(), result.pairs.size());
      for (std::size_t i = 0; i < result.pairs.size(); ++i) {
        const auto& pair = result.pairs[i];
        auto& same = tracked.pairs()[i];
        ASSERT_EQ(same.o1, pair.o1);
        ASSERT_EQ(same.o2, pair.o2);
        const auto old = before.find({pair.o1, pair.o2});
        Known known{same.id, same.num_steps, {}};
        ASSERT_EQ(same.isNew(), old == before.end());
        if (same.isNew()) {
          ++num_added;
          ASSERT_TRUE(ids.insert(same.id).second);
          ASSERT_TRUE(same.data.empty());
        } else {
          ++num_kept;
          --num_gone;
          ASSERT_EQ(same.id, old->second.id);
          ASSERT_EQ(same.num_steps, old->second.num_steps + 1);
          ASSERT_EQ(same.data,
                    std::vector<std::uint64_t>(old->second.num_steps, same.id));
        }
        same.data.push_back(same.id);
        const auto& contacts = pair.result.contacts;
        ASSERT_EQ(same.previous.size(), contacts.size());
        for (std::size_t k = 0; k < contacts.size(); ++k) {
          const std::string name = nameOf(contacts[k]);
          known.contacts[name] = std::ptrdiff_t(k);
          std::ptrdiff_t expected = -1;
          if (old != before.end()) {
            const auto contact = old->second.contacts.find(name);
            if (contact != old->second.contacts.end()) expected = contact->second;
          }
          ASSERT_EQ(same.previous[k], expected) << name;
          ++(expected < 0 ? num_new : num_same);
        }
        ASSERT_EQ(known.contacts.size(), contacts.size());
        now[{pair.o1, pair.o2}] = known;
      }
      ASSERT_EQ(tracked.removed().size(), num_gone);
      num_removed += num_gone;
      for (const auto& gone : tracked.removed()) {
        const auto old = before.find({gone.o1, gone.o2});
        ASSERT_NE(old, before.end());
        ASSERT_EQ(now.count({gone.o1, gone.o2}), 0u);
        ASSERT_EQ(gone.id, old->second.id);
        ASSERT_EQ(gone.data, std::vector<std::uint64_t>(old->second.num_steps, gone.id));
      }
      before = now;
    }
  }
  const std::size_t few = rounds(20);
  EXPECT_GT(num_added, few);
  EXPECT_GT(num_kept, few);
  EXPECT_GT(num_removed, few);
  EXPECT_GT(num_same, few);
  EXPECT_GT(num_new, few);
}

/// A sheet that sinks on another one and stays, and a ball that goes.
TEST(FCL_PERSISTENT_PAIRS, ForgetsAnObject) {
  const auto ball = std::make_shared<Sphere<double>>(1);
  std::vector<std::unique_ptr<Object>> balls;
  Manager manager;
  for (int i = 0; i < 4; ++i) {
    balls.push_back(makeObject(ball, translation(V(1.5 * i, 0, 0), V(1.5 * i, 0, 0))));
    manager.registerObject(balls.back().get());
  }
  PersistentPairs<double, std::string> tracked;
  Result result;
  manager.collide(Request(), result);
  tracked.update(result);
  ASSERT_EQ(tracked.pairs().size(), 3u);
  for (auto& pair : tracked.pairs()) pair.data = "kept";
  manager.unregisterObject(balls[1].get());
  tracked.forget(balls[1].get());
  manager.collide(Request(), result);
  tracked.update(result);
  ASSERT_EQ(tracked.pairs().size(), 1u);
  EXPECT_TRUE(tracked.removed().empty());
  EXPECT_EQ(tracked.pairs()[0].data, "kept");
  EXPECT_EQ(tracked.pairs()[0].num_steps, 2u);
  // The same object again is new.
  manager.registerObject(balls[1].get());
  manager.collide(Request(), result);
  tracked.update(result);
  EXPECT_EQ(std::count_if(tracked.pairs().begin(), tracked.pairs().end(),
                          [](const auto& pair) { return pair.isNew(); }),
            2);
  const auto copy = tracked;
  tracked.clear();
  EXPECT_TRUE(tracked.pairs().empty() && tracked.removed().empty());
  tracked.update(result);
  EXPECT_TRUE(tracked.pairs()[0].isNew());
  EXPECT_EQ(copy.pairs().size(), 3u);
}

/// In a self-collision no edge of a pair is the first one. Two objects may share a mesh.
TEST(FCL_PERSISTENT_PAIRS, KeysDoNotDependOnOrder) {
  ContinuousContact<double> contact;
  contact.kind = ContinuousContactKind::kEdgeEdge;
  contact.vertices = {{7, 3, 2, 9, -1}};
  ContinuousContact<double> turned = contact;
  turned.vertices = {{9, 2, 3, 7, -1}};
  const auto areSame = [&](bool is_self) {
    return detail::contactKey(contact, is_self) == detail::contactKey(turned, is_self);
  };
  EXPECT_TRUE(areSame(true));
  EXPECT_FALSE(areSame(false));
  turned.vertices = {{3, 7, 9, 2, -1}};
  EXPECT_TRUE(areSame(false));
  contact.kind = turned.kind = ContinuousContactKind::kVertexFace;
  contact.vertices = {{4, 1, 2, 3, -1}};
  turned.vertices = {{4, 3, 1, 2, -1}};
  EXPECT_TRUE(areSame(false));
  turned.first_on_o1 = false;
  EXPECT_FALSE(areSame(false));
  contact.kind = ContinuousContactKind::kVertexShape;
  turned.kind = ContinuousContactKind::kFaceShape;
  turned.first_on_o1 = true;
  contact.b1 = turned.b1 = 5;
  EXPECT_TRUE(areSame(false));
  turned.b2 = (std::intptr_t{1} << 32) - 1;
  EXPECT_FALSE(areSame(false));
}

TEST(FCL_PERSISTENT_PAIRS, ObjectsThatShareAMesh) {
  const auto tip = makeModel<Model>(makeTetrahedronSoup(1, .1, 1, 3));
  const auto one = makeObject(tip, translation(V::Zero(), V::Zero())),
             two = makeObject(tip, translation(V::Zero(), V::Zero()));
  ContinuousManagerResult<double> result;
  result.pairs.emplace_back();
  auto& pair = result.pairs[0];
  pair.o1 = one.get();
  pair.o2 = two.get();
  ContinuousContact<double> contact;
  contact.o1 = contact.o2 = tip.get();
  contact.vertices = {{0, 1, 2, 3, -1}};
  pair.result.contacts = {contact};
  PersistentPairs<double> tracked;
  tracked.update(result);
  // The same ids, on the other side.
  pair.result.contacts[0].first_on_o1 = false;
  tracked.update(result);
  EXPECT_EQ(tracked.pairs()[0].previous, std::vector<std::ptrdiff_t>{-1});
  tracked.update(result);
  EXPECT_EQ(tracked.pairs()[0].previous, std::vector<std::ptrdiff_t>{0});
  // A pair that comes twice is refused, and nothing changes.
  result.pairs.push_back(pair);
  expectRefused([&] { tracked.update(result); }, "twice in the answer");
  EXPECT_EQ(tracked.pairs().size(), 1u);
  EXPECT_EQ(tracked.pairs()[0].num_steps, 3u);
}

/// Pairs come one by one, with the same answers as in the list.
TEST(FCL_MANAGER_VISIT, GivesThePairsOfTheList) {
  Random random(23);
  std::size_t num_pairs = 0;
  for (int round = 0; round < rounds(20); ++round) {
    const ManagerScene scene(random, 60);
    Request request;
    request.num_threads = round % 2 == 0 ? 1 : 3;
    Result result;
    scene.manager.collide(request, result);
    std::vector<ContinuousPairResult<double>> visited;
    scene.manager.collide(request, [&](ContinuousPairResult<double>& pair) {
      visited.push_back(std::move(pair));
      return false;
    });
    detail::sortByTime<double>(visited);
    ASSERT_EQ(visited.size(), result.pairs.size());
    for (std::size_t i = 0; i < visited.size(); ++i) {
      ASSERT_EQ(visited[i].o1, result.pairs[i].o1);
      ASSERT_EQ(visited[i].o2, result.pairs[i].o2);
      expectIdentical(visited[i].result, result.pairs[i].result);
    }
    num_pairs += visited.size();
    if (visited.empty()) continue;
    std::size_t num_calls = 0;
    scene.manager.collide(request, [&](ContinuousPairResult<double>&) {
      return ++num_calls == std::min<std::size_t>(2, visited.size());
    });
    EXPECT_EQ(num_calls, std::min<std::size_t>(2, visited.size()));
    for (const auto query : {ContinuousQuery::kFirst, ContinuousQuery::kAny}) {
      request.query = query;
      scene.manager.collide(request, result);
      num_calls = 0;
      scene.manager.collide(request, [&](ContinuousPairResult<double>& pair) {
        ++num_calls;
        EXPECT_EQ(pair.o1, result.pairs[0].o1);
        EXPECT_EQ(pair.o2, result.pairs[0].o2);
        return false;
      });
      EXPECT_EQ(num_calls, 1u);
    }
  }
  EXPECT_GT(num_pairs, std::size_t{rounds(20)});
  const Manager empty;
  expectRefused(
      [&] {
        empty.collide(Request(), std::function<bool(ContinuousPairResult<double>&)>());
      },
      "the function for pairs is empty");
}

TEST(FCL_MANAGER_VISIT, GroupsAsATable) {
  ContinuousGroups groups;
  EXPECT_TRUE(groups.canMeet(0, 31));
  groups.set(1, 1, false);
  groups.set(1, 2, false);
  Random random(3);
  bool table[32][32];
  for (auto& row : table) std::fill(row, row + 32, true);
  table[1][1] = table[1][2] = table[2][1] = false;
  for (int i = 0; i < 500; ++i) {
    const int a = int(random.index(32)), b = int(random.index(32));
    const bool can = random.index(2) == 0;
    groups.set(a, b, can);
    table[a][b] = table[b][a] = can;
  }
  const auto accepts = [](const ContinuousFilter& x, const ContinuousFilter& y) {
    return (x.group & y.mask) && (y.group & x.mask);
  };
  for (int a = 0; a < 32; ++a)
    for (int b = 0; b < 32; ++b) {
      EXPECT_EQ(groups.canMeet(a, b), table[a][b]);
      EXPECT_EQ(accepts(groups.filterOf(a), groups.filterOf(b)), table[a][b]);
    }
  expectRefused([&] { groups.set(32, 0, true); }, "there is no group 32");
  expectRefused([&] { groups.set(0, -1, true); }, "there is no group -1");
  expectRefused([&] { groups.filterOf(40); }, "there is no group 40");
  expectRefused([&] { groups.canMeet(0, 99); }, "there is no group 99");
}

TEST(FCL_MANAGER_VISIT, ApproachSpeedOfAnObject) {
  // A box stands on a floor of meshes and slides; another one sinks into it.
  const auto floor = makeModel<Model>(makeBox({5, 5, .5})),
             box = makeModel<Model>(makeBox({.5, .5, .5}));
  const auto ground = makeObject(floor, translation(V(0, 0, -.5), V(0, 0, -.5))),
             slides = makeObject(box, translation(V(0, 0, .5), V(1, 0, .5))),
             falls = makeObject(box, translation(V(3, 0, .6), V(3, 0, .4)));
  Manager manager;
  manager.registerObjects({ground.get(), slides.get(), falls.get()});
  const auto inContact = [&manager](double speed) {
    Request request;
    request.min_approach_speed = speed;
    Result result;
    manager.collide(request, result);
    std::set<const Object*> objects;
    for (const auto& pair : result.pairs) objects.insert(pair.o2);
    return objects;
  };
  using Set = std::set<const Object*>;
  EXPECT_EQ(inContact(0), (Set{slides.get(), falls.get()}));
  EXPECT_EQ(inContact(1e-3), Set{falls.get()});
  manager.setMinApproachSpeed(slides.get(), 1e-3);
  EXPECT_EQ(inContact(0), Set{falls.get()});
  // The least distance is that of the geometries: what slides touches, and is the first.
  ContinuousManagerDistance<double> nearest;
  manager.distance(ContinuousDistanceRequest<double>(), nearest);
  EXPECT_EQ(nearest.o2, slides.get());
  EXPECT_EQ(nearest.result.time, 0);
  manager.setMinApproachSpeed(slides.get(), 0);
  EXPECT_EQ(inContact(0), (Set{slides.get(), falls.get()}));
  // Of two objects, and the request, the larger speed counts.
  manager.setMinApproachSpeed(ground.get(), 1);
  EXPECT_EQ(inContact(1e-3), Set());
  manager.setMinApproachSpeed(ground.get(), 1e-3);
  EXPECT_EQ(inContact(1), Set());
  // It does not act where the request's would be refused.
  const auto ball = makeObject(std::make_shared<Sphere<double>>(.5),
                               translation(V(-3, 0, .5), V(-3, 1, .5)));
  manager.registerObject(ball.get());
  EXPECT_EQ(inContact(0), (Set{ball.get(), falls.get()}));
  manager.unregisterObject(ground.get());
  manager.registerObject(ground.get());
  Result result;
  manager.collide(ground.get(), Request(), result);
  EXPECT_EQ(result.pairs.size(), 3u);
  expectRefused([&] { manager.setMinApproachSpeed(slides.get(), -1); },
                "the speed is negative or not finite");
  manager.unregisterObject(ball.get());
  expectRefused([&] { manager.setMinApproachSpeed(ball.get(), 1); }, "not registered");
}

}  // namespace
}  // namespace test
}  // namespace fcl

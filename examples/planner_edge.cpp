// SPDX-License-Identifier: BSD-3-Clause
//
// Edges of a planner: an arm of six joints that holds a rod, between two posts. Its
// straight edge in joint space is proved free of contact, also with itself. A larger one
// is not: the bodies, the time and the joint values of the first contact are named.
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include <fcl/broadphase/collision_robot.h>
#include <fcl/geometry/geometric_shape_to_BVH_model.h>
#include <fcl/math/motion/translation_motion.h>

using namespace fcl;

/// A joint as a URDF has it, and the capsule of its link.
struct Joint {
  const char* name;
  Vector3d xyz, axis, to_next;
  double radius;
};
const Joint joints[] = {
    {"turret", {0, 0, .1}, {0, 0, 1}, {0, 0, .3}, .08},
    {"upper arm", {0, 0, .3}, {0, 1, 0}, {0, 0, .45}, .06},
    {"elbow", {0, 0, .45}, {0, 1, 0}, {0, 0, .15}, .06},
    {"forearm", {0, 0, .15}, {1, 0, 0}, {.35, 0, 0}, .05},
    {"wrist", {.35, 0, 0}, {0, 1, 0}, {.12, 0, 0}, .045},
    {"hand", {.12, 0, 0}, {1, 0, 0}, {.15, 0, 0}, .03},
};

/// The frame of a capsule from the origin to a point: it lies along z.
Transform3d alongBone(const Vector3d& to) {
  Transform3d tf(Translation3d(to / 2));
  tf.linear() = Quaterniond::FromTwoVectors(Vector3d::UnitZ(), to).toRotationMatrix();
  return tf;
}

int main() {
  JointChain chain;
  std::vector<std::string> names;
  for (const Joint& joint : joints) {
    chain.addRevolute(urdfOrigin(joint.xyz, {0, 0, 0}), joint.axis);
    names.push_back(joint.name);
  }
  CollisionRobotd arm(chain, names);
  arm.allowNeighbours();  // links that a joint connects touch
  for (int i = 0; i < 6; ++i) {
    const Vector3d bone = joints[i].to_next;
    arm.attach(i, std::make_shared<Capsuled>(joints[i].radius, bone.norm()),
               alongBone(bone));
  }
  const auto rod = std::make_shared<BVHModel<OBBRSSd>>();
  generateBVHModel(*rod, Boxd(.02, .4, .02), Transform3d::Identity());
  arm.attach(5, rod, Transform3d(Translation3d(.17, 0, 0)));

  const auto post = std::make_shared<Boxd>(.04, .04, 1);
  std::vector<ContinuousCollisionObjectd> posts;
  for (const double y : {-.5, .5}) {
    const Transform3d pose(Translation3d(.6, y, .5));
    posts.emplace_back(post, std::make_shared<TranslationMotion<double>>(pose, pose));
  }
  ContinuousCollisionManagerd obstacles;
  for (auto& one : posts) obstacles.registerObject(&one);

  // Between the posts: the hand goes down, and turns the rod upright.
  const std::vector<double> from{0, .3, .2, 0, .3, 0}, to{0, .9, .4, .5, .2, 1.2},
      far{1.2, .9, .4, .5, .2, 1.2};
  ContinuousContactRequestd request;
  request.query = ContinuousQuery::kFirst;
  RobotEdgeResultd result;
  const bool is_free = arm.checkEdge(from, to, &obstacles, request, result);
  std::printf("the first edge is %s\n", is_free ? "free" : "not free");

  if (arm.checkEdge(from, far, &obstacles, request, result)) return 1;
  const auto& first = result.pairs[0];
  std::printf("the second one is free until %.4f: part %d of %s meets %s\n",
              result.time_of_contact, first.part1, arm.nameOf(first.link1).c_str(),
              first.object == &posts[1] ? "the left post" : "something else");
  std::printf("the turret is at %.4f then\n", result.joint_values[0]);
  return is_free && first.object == &posts[1] ? 0 : 1;
}

// SPDX-License-Identifier: BSD-3-Clause
#include "figures.h"

#include <algorithm>
#include <cmath>

namespace fcl {
namespace test {
namespace {

using Vec = Vector3<double>;
using Pose = Transform3<double>;

const double kPi = std::acos(-1.0);
const double kHip = 0.87;      // height of the hip joints, metres
const double kThigh = 0.44;    // length of a thigh, joint to joint
const double kShin = 0.42;     // of a shin, to the heel
const double kHipGap = 0.24;   // from the hip joint, inside the trunk, to the thigh
const double kKneeGap = 0.06;  // from a knee to the limbs' ends, which a bent knee needs
const double kEndGap = 0.01;   // from shoulders, hands and heels

double smoothStep(double x) {
  x = std::max(0.0, std::min(1.0, x));
  return x * x * x * (10 + x * (6 * x - 15));
}

Pose turned(double angle, const Vec& axis) {
  Pose pose = Pose::Identity();
  pose.rotate(Eigen::AngleAxisd(angle, axis));
  return pose;
}

Pose moved(const Vec& by) {
  Pose pose = Pose::Identity();
  pose.translation() = by;
  return pose;
}

/// Head, trunk to the crotch; z is the height when standing.
TestMesh makeTrunk(double scale) {
  return makeLathe(scaled(36, scale, 8), {{0, 1.44},
                                          {0.06, 1.435},
                                          {0.13, 1.40},
                                          {0.15, 1.34},
                                          {0.14, 1.26},
                                          {0.13, 1.18},
                                          {0.125, 1.12},
                                          {0.13, 1.06},
                                          {0.145, 1.01},
                                          {0.16, 0.96},
                                          {0.165, 0.92},
                                          {0.16, 0.88},
                                          {0.14, 0.84},
                                          {0.10, 0.815},
                                          {0.05, 0.805},
                                          {0, 0.80}});
}

/// A limb along z, from `gap` after a joint at the origin to `end_gap` before `length`.
TestMesh makeLimb(double radius, double length, double gap, double end_gap,
                  double scale) {
  return transformed(makeCapsule(scaled(16, scale), scaled(4, scale, 2), radius,
                                 length - gap - end_gap - 2 * radius),
                     moved(Vec(0, 0, radius + gap)));
}

/// From `from` on, with the z axis towards `to`; both in one plane of constant x.
Pose along(const Vec& from, const Vec& to) {
  const Vec d = to - from;
  return moved(from) * turned(std::atan2(-d[1], d[2]), Vec::UnitX());
}

/// Where a knee is between hip and heel, in front (-y).
Vec kneeBetween(const Vec& hip, const Vec& heel) {
  const Vec d = heel - hip;
  const double distance = std::min(d.norm(), 0.9999 * (kThigh + kShin));
  const double along_leg =
      (distance * distance + kThigh * kThigh - kShin * kShin) / (2 * distance);
  const double aside = std::sqrt(std::max(0.0, kThigh * kThigh - along_leg * along_leg));
  const Vec direction = d.normalized();
  Vec front(0, direction[2], -direction[1]);
  if (front[1] > 0) front = -front;
  return hip + along_leg * direction + aside * front;
}

/// The parts of a figure whose trunk and heels move in given ways.
/// @param root  of the whole figure, trunk  relative to it, heel  of a side (-1 or 1)
/// relative to the root
Figure makeFigure(double scale, const ObstacleMotion& root, const ObstacleMotion& trunk,
                  const std::function<Vec(double side, double time)>& heel,
                  const std::function<Pose(double side, double time)>& arm) {
  Figure figure;
  const auto whole = [=](double time) { return root(time) * trunk(time); };
  figure.push_back({makeTrunk(scale), whole});
  figure.push_back(
      {transformed(makeGeodesicSphere(scaled(6, scale), 0.11), moved(Vec(0, 0, 1.57))),
       whole});
  const TestMesh thigh = makeLimb(0.058, kThigh, kHipGap, kKneeGap, scale);
  const TestMesh shin = makeLimb(0.05, kShin, kKneeGap, kEndGap, scale);
  const TestMesh upper_arm = makeLimb(0.038, 0.6, kEndGap, kEndGap, scale);
  for (const double side : {-1.0, 1.0}) {
    const auto hip = [=](double time) {
      return Vec(trunk(time) * Vec(0.085 * side, 0, kHip));
    };
    const auto knee = [=](double time) {
      return kneeBetween(hip(time), heel(side, time));
    };
    figure.push_back(
        {thigh, [=](double time) { return root(time) * along(hip(time), knee(time)); }});
    figure.push_back({shin, [=](double time) {
                        return root(time) * along(knee(time), heel(side, time));
                      }});
    figure.push_back({upper_arm, [=](double time) {
                        return whole(time) * moved(Vec(0.19 * side, 0, 1.36)) *
                               arm(side, time);
                      }});
  }
  return figure;
}

}  // namespace

int scaled(int divisions, double scale, int at_least) {
  return std::max(at_least, static_cast<int>(std::lround(divisions * std::sqrt(scale))));
}

Figure makeDancer(double scale) {
  const auto root = [](double time) {
    // Turns one way, then the other, faster each time.
    const double angle = 2.2 * std::sin(3.3 * time) * smoothStep(2 * time);
    return turned(angle, Vec::UnitZ());
  };
  const auto trunk = [](double time) {
    const double sway = smoothStep(2 * time);
    return moved(sway * Vec(0.05 * std::sin(5 * time), 0.03 * std::sin(7 * time),
                            -0.02 + 0.02 * std::cos(6 * time))) *
           turned(0.05 * sway * std::sin(5 * time), Vec::UnitY());
  };
  const auto heel = [](double side, double time) {
    const double lift =
        0.22 * smoothStep(2 * time) * std::max(0.0, side * std::sin(6 * time));
    return Vec(0.085 * side, -0.9 * lift, 0.03 + 0.6 * lift);
  };
  const auto arm = [](double side, double time) {
    return turned(side * (1.9 + 0.4 * std::sin(4 * time + side)), Vec::UnitY()) *
           moved(Vec(0, 0, 0.03)) * turned(kPi, Vec::UnitZ());
  };
  return makeFigure(scale, root, trunk, heel, arm);
}

Figure makeSittingFigure(double scale) {
  const auto down = [](double time) { return smoothStep((time - 0.2) / 1.2); };
  const auto root = [](double) { return Pose::Identity(); };
  const auto trunk = [=](double time) {
    // The lowest point of the trunk, 0.80 m up, comes down to 0.03 m.
    const double s = down(time);
    const double lean = 0.35 * std::sin(kPi * s);
    return moved(Vec(0, 0.34 * s, -0.77 * s)) * moved(Vec(0, 0, 0.9)) *
           turned(lean, Vec::UnitX()) * moved(Vec(0, 0, -0.9));
  };
  const auto heel = [=](double side, double time) {
    return Vec(0.085 * side, -0.05 - 0.25 * down(time), 0.03);
  };
  const auto arm = [=](double side, double time) {
    return turned(kPi - side * 0.5 - side * 0.4 * down(time), Vec::UnitY());
  };
  return makeFigure(scale, root, trunk, heel, arm);
}

TestMesh makeSkirt(const Skirt& skirt, double scale) {
  return makeTube(scaled(skirt.columns, scale, 12), scaled(skirt.rows, scale),
                  [&](double u, double v) {
                    const double r =
                        skirt.radius + v * skirt.length * std::sin(skirt.slope);
                    return Vec(r * std::cos(2 * kPi * u), -r * std::sin(2 * kPi * u),
                               skirt.height - v * skirt.length * std::cos(skirt.slope));
                  });
}

}  // namespace test
}  // namespace fcl

// SPDX-License-Identifier: BSD-3-Clause
//
// The order of contacts, and the table of those whose pairs may come again.
#include "query/contact_sink.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <deque>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "mesh_generators.h"
#include "query/contact_table.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

using test::Random;

FeatureContact randomContact(Random& random, std::size_t vertices, double at_start) {
  FeatureContact contact{};
  contact.kind = static_cast<ContinuousContactKind>(random.index(5));
  contact.first_on_a = random.index(4) != 0;
  for (std::uint32_t& v : contact.vertices)
    v = static_cast<std::uint32_t>(random.index(vertices));
  contact.toc_lo = random.uniform(0, 1) < at_start ? 0 : random.uniform(0, 1);
  contact.toc_hi = contact.toc_lo;
  return contact;
}

std::array<std::uint32_t, 5> nameOf(const FeatureContact& c) {
  std::array<std::uint32_t, 5> name{
      2 * static_cast<std::uint32_t>(c.kind) + (c.first_on_a ? 1U : 0U), c.vertices[0],
      c.vertices[1], c.vertices[2], c.vertices[3]};
  if (c.kind == ContinuousContactKind::kVertexFace)
    std::sort(name.begin() + 2, name.end());
  return name;
}

// None, few or all contacts at t = 0, of many vertices or of one.
TEST(FCL_CONTACT_SINK, contactsAreInOrder) {
  constexpr std::uint64_t kSeed = 395;
  Random random(kSeed);
  for (int i = 0; i < 400; ++i) {
    SCOPED_TRACE("seed " + std::to_string(kSeed) + ", " + std::to_string(i));
    const double at_start[] = {0, 0.3, 1};
    const std::size_t vertices = random.index(4) ? 1 + random.index(300) : 1;
    std::vector<std::deque<FeatureContact>> lists(random.index(4));
    std::vector<FeatureContact> expected;
    for (auto& list : lists)
      for (std::size_t k = random.index(200); k > 0; --k) {
        list.push_back(randomContact(random, vertices, at_start[i % 3]));
        expected.push_back(list.back());
      }
    std::sort(expected.begin(), expected.end(), isEarlier);
    const SortedContacts sorted(std::move(lists));
    ASSERT_EQ(sorted.size(), expected.size());
    for (std::size_t k = 0; k < expected.size(); ++k) {
      EXPECT_FALSE(isEarlier(sorted[k], expected[k]));
      EXPECT_FALSE(isEarlier(expected[k], sorted[k]));
    }
    ASSERT_FALSE(HasFailure());
  }
}

// What is left out by the bound would not be kept.
TEST(FCL_CONTACT_SINK, lastVertexAtStart) {
  constexpr std::uint64_t kSeed = 92;
  Random random(kSeed);
  int bounds = 0, kept = 0;
  for (int i = 0; i < 3000; ++i) {
    SCOPED_TRACE("seed " + std::to_string(kSeed) + ", " + std::to_string(i));
    ContactSink sink(1 + random.index(4), false);
    for (std::size_t k = random.index(100); k > 0; --k)
      sink.add(randomContact(random, 30, 0.95));
    const std::uint32_t last = sink.lastVertexAtStart();
    if (last == ~std::uint32_t{0}) continue;
    ++bounds;
    for (int k = 0; k < 20; ++k) {
      const FeatureContact contact = randomContact(random, 30, 1);
      const bool is_left_out =
          *std::min_element(contact.vertices, contact.vertices + 4) > last;
      EXPECT_FALSE(is_left_out && sink.mayKeep(contact, 0));
      if (!is_left_out) kept += sink.add(contact);
      if (sink.lastVertexAtStart() != last) break;
    }
  }
  EXPECT_GT(bounds, 500);
  EXPECT_GT(kept, 100);
}

// mayKeep() is false only of what would not be kept.
TEST(FCL_CONTACT_SINK, mayKeep) {
  constexpr std::uint64_t kSeed = 93;
  Random random(kSeed);
  int kept = 0, left_out = 0;
  for (int i = 0; i < 3000; ++i) {
    SCOPED_TRACE("seed " + std::to_string(kSeed) + ", " + std::to_string(i));
    ContactSink sink(1 + random.index(4), false);
    for (int k = 0; k < 40; ++k) {
      const FeatureContact contact = randomContact(random, 30, 0.5);
      const double earliest = contact.toc_lo * (random.index(2) == 0 ? 1 : 0.5);
      const bool may_keep = sink.mayKeep(contact, earliest);
      const bool is_kept = sink.add(contact);
      EXPECT_TRUE(may_keep || !is_kept);
      // With the time itself it is known, as soon as a contact was dropped.
      if (earliest == contact.toc_lo && k > 4) {
        EXPECT_EQ(may_keep, is_kept);
      }
      kept += is_kept;
      left_out += !may_keep;
    }
    ASSERT_FALSE(HasFailure());
  }
  EXPECT_GT(kept, 10000);
  EXPECT_GT(left_out, 50000);
}

// Against a map, with contacts that are taken out again.
TEST(FCL_CONTACT_SINK, tableOfContacts) {
  constexpr std::uint64_t kSeed = 396;
  Random random(kSeed);
  std::size_t known = 0, removed = 0;
  ContactTable<FeatureContact> table;
  for (int i = 0; i < 100; ++i) {
    SCOPED_TRACE("seed " + std::to_string(kSeed) + ", " + std::to_string(i));
    const std::size_t vertices = 2 + random.index(6);
    std::deque<FeatureContact> contacts;
    std::map<std::array<std::uint32_t, 5>, FeatureContact*> expected;
    for (std::size_t k = random.index(2000); k > 0; --k) {
      const FeatureContact contact = randomContact(random, vertices, 0);
      const auto at = expected.find(nameOf(contact));
      FeatureContact* found = table.find(contact);
      ASSERT_EQ(found, at == expected.end() ? nullptr : at->second);
      known += found != nullptr;
      if (!found) {
        contacts.push_back(contact);
        if (random.index(2))
          table.add(contacts.back());
        else
          ASSERT_EQ(table.findOrAdd(contacts.back()), nullptr);
        expected[nameOf(contact)] = &contacts.back();
      } else if (random.index(2)) {
        FeatureContact again = contact;
        ASSERT_EQ(table.findOrAdd(again), found);
      } else if (random.index(2)) {
        table.remove(*found);
        expected.erase(at);
        ++removed;
      }
    }
    for (const auto& [name, contact] : expected) ASSERT_EQ(table.find(*contact), contact);
    table.clear();
    for (const auto& [name, contact] : expected) ASSERT_EQ(table.find(*contact), nullptr);
  }
  EXPECT_GT(known, 5000U);
  EXPECT_GT(removed, 2500U);
}

}  // namespace
}  // namespace deformable
}  // namespace detail
}  // namespace fcl

// SPDX-License-Identifier: BSD-3-Clause
#include "report_page.h"

#include "fcl/ccd_version.h"
#include "json.h"
#include "page_block.h"
#include "page_parts.h"
#include "page_step.h"

namespace fcl_ccd {
namespace {

std::string script(const char* text) {
  return std::string("<script>\n") + text + "</script>\n";
}

}  // namespace

ReportPage::ReportPage(const std::string& path) : file_(path) {
  file_.write(std::string("<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n"
                          "<meta charset=\"utf-8\">\n<meta name=\"viewport\" "
                          "content=\"width=device-width, initial-scale=1\">\n"
                          "<title>Contacts of a run of fcl-ccd</title>\n<style>\n") +
              kPageStyle + "</style>\n</head>\n<body>\n");
}

void ReportPage::finish(const std::string& sentence, const std::string& picture,
                        bool is_complete) {
  const Json summary = {{"program", "fcl-ccd " FCL_CCD_VERSION},
                        {"sentence", sentence},
                        {"complete", is_complete}};
  file_.write("<script type=\"application/json\" class=\"summary\">" +
              scriptText(summary) + "</script>\n" +
              "<script type=\"text/plain\" class=\"picture\">" + base64(picture) +
              "</script>\n" + kPageBody);
  // The parts that the scripts fill are there when these run.
  file_.write(script(kPageBlocks) + script(kPageViewer) + script(kPageScript) +
              "</body>\n</html>\n");
}

}  // namespace fcl_ccd

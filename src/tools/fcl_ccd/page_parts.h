// SPDX-License-Identifier: BSD-3-Clause
//
// The files of report_page/ as texts. The build writes page_parts.cpp
// (report_page/embed.cmake).
#ifndef FCL_CCD_PAGE_PARTS_H
#define FCL_CCD_PAGE_PARTS_H

namespace fcl_ccd {

extern const char* const kPageStyle;   ///< page.css
extern const char* const kPageBody;    ///< body.html
extern const char* const kPageBlocks;  ///< blocks.js
extern const char* const kPageScript;  ///< page.js
/// viewer.js with three.js and its licence; empty if it was not built
extern const char* const kPageViewer;

}  // namespace fcl_ccd

#endif

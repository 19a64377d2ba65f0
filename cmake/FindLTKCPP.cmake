# The LLRP Toolkit's C++ library (Apache-2.0), which no package registry has: built by its user. LTKCPP_ROOT says
# where: a folder with ltkcpp.h and the library, or the toolkit's LTK/LTKCPP. Sets LTKCPP_FOUND and LTKCPP::ltkcpp.
find_path(LTKCPP_INCLUDE_DIR ltkcpp.h HINTS ${LTKCPP_ROOT} PATH_SUFFIXES include ltkcpp Library LTKCPP/Library
                                                                         include/ltkcpp)
find_library(LTKCPP_LIBRARY NAMES ltkcpp ltkcpp_x86_64 ltkcpp_armv7l ltkcpp_atmel HINTS ${LTKCPP_ROOT}
             PATH_SUFFIXES lib ltkcpp Library LTKCPP/Library)
find_package(LibXml2 QUIET)  # the library writes XML
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(LTKCPP REQUIRED_VARS LTKCPP_LIBRARY LTKCPP_INCLUDE_DIR LIBXML2_LIBRARY
  REASON_FAILURE_MESSAGE "no LLRP Toolkit C++ library (ltkcpp.h, libltkcpp and libxml2) at LTKCPP_ROOT=\"${LTKCPP_ROOT}\"")
if(LTKCPP_FOUND AND NOT TARGET LTKCPP::ltkcpp)
  add_library(LTKCPP::ltkcpp UNKNOWN IMPORTED)
  set_target_properties(LTKCPP::ltkcpp PROPERTIES IMPORTED_LOCATION ${LTKCPP_LIBRARY}
                                                  INTERFACE_INCLUDE_DIRECTORIES ${LTKCPP_INCLUDE_DIR}
                                                  INTERFACE_LINK_LIBRARIES LibXml2::LibXml2)
endif()
mark_as_advanced(LTKCPP_INCLUDE_DIR LTKCPP_LIBRARY)

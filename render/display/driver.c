/* Asks EGL for the name of Mesa's driver. */
#include "render/display/driver.h"

#include <string.h>

#include <EGL/eglext.h>

bool driver_is_software(EGLDisplay egl)
{
	const char *all = eglQueryString(egl, EGL_EXTENSIONS), *driver = NULL;
	PFNEGLGETDISPLAYDRIVERNAMEPROC name_of =
		(PFNEGLGETDISPLAYDRIVERNAMEPROC)eglGetProcAddress("eglGetDisplayDriverName");

	if (all && strstr(all, "EGL_MESA_query_driver") && name_of)
		driver = name_of(egl);
	return driver && strstr(driver, "swrast"); /* "swrast", "kms_swrast" */
}

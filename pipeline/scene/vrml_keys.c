/* Reads the keys of an interpolator (ISO/IEC 14772-1 4.6.8). */
#include "pipeline/scene/vrml_keys.h"

#include <errno.h>

/* Returns what is wrong with an interpolator, or NULL. */
static const char *fault_of(const struct vrml_value *keys, const struct vrml_value *values,
			    uint32_t width)
{
	if (!keys || !values || keys->count == 0)
		return "has no keys";
	if (values->count != (uint64_t)keys->count * width)
		return "has another number of keys than of values";
	for (uint32_t i = 0; i < keys->count; i++)
		if (keys->floats[i] < 0 || keys->floats[i] > 1 ||
		    (i > 0 && keys->floats[i] < keys->floats[i - 1]))
			return "has keys that do not ascend from 0 to 1";
	return NULL;
}

int vrml_keys(const struct vrml_node *interpolator, uint32_t width, const struct vrml_value **keys,
	      const struct vrml_value **values, struct diagnostics *diagnostics)
{
	const char *fault;

	*keys = vrml_get(interpolator, "key");
	*values = vrml_get(interpolator, "keyValue");
	fault = fault_of(*keys, *values, width);
	return fault ? diagnostics_add(diagnostics, -EBADMSG, interpolator->file,
				       interpolator->line, "%s %s; correct them",
				       interpolator->type->name, fault)
		     : 0;
}

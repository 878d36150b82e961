/* Opens and closes the scene and the information of one release together. */
#include "app/view/exhibit.h"

int exhibit_open(struct exhibit *exhibit, struct hash root, uint32_t root_bytes,
		 const struct scene_options *scene, const struct information_view_options *view)
{
	int rc;

	*exhibit = (struct exhibit){ .root = root, .root_bytes = root_bytes };
	rc = scene_create(&exhibit->scene, scene);
	if (rc == 0)
		rc = information_view_create(&exhibit->view, view);
	if (rc == 0)
		rc = scene_open(exhibit->scene, root, root_bytes);
	if (rc < 0)
		exhibit_close(exhibit);
	return rc;
}

void exhibit_close(struct exhibit *exhibit)
{
	information_view_destroy(exhibit->view);
	scene_destroy(exhibit->scene);
	*exhibit = (struct exhibit){ 0 };
}

bool exhibit_is_broken(const struct exhibit *exhibit)
{
	return exhibit->scene &&
	       (scene_refused(exhibit->scene) > 0 || information_view_broken(exhibit->view));
}

struct overlay *exhibit_overlay(const struct exhibit *exhibit)
{
	return information_view_overlay(exhibit->view);
}

const struct info *exhibit_info(const struct exhibit *exhibit)
{
	return information_view_info(exhibit->view);
}

"""The documentation of the package. Its notebooks are executed when it is built."""

import arclength

project = "arclength"
author = "The kingpin authors"
copyright = author
release = version = arclength.__version__

extensions = ["sphinx.ext.autodoc", "sphinx.ext.napoleon", "myst_nb"]
exclude_patterns = ["_build"]
html_theme = "alabaster"
html_theme_options = {"description": "Continuation and bifurcations in Python; towed wheels", "page_width": "1080px"}
html_sidebars = {"**": ["about.html", "navigation.html", "searchfield.html"]}

# A cell that fails is an error of the build; a page takes its numbers and pictures from the installed package.
nb_execution_mode = "force"
nb_execution_raise_on_error = True
nb_execution_timeout = 300
nb_merge_streams = True
myst_heading_anchors = 3

autodoc_member_order = "bysource"
autodoc_typehints = "none"

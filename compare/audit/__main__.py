"""`python -m compare.audit`."""

import sys

from .run import main

sys.exit(main())

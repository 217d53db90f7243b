"""From the download of a learning management system (LMS) to notebooks in ``submitted``."""

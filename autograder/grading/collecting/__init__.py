"""From the download of a learning management system to notebooks in ``submitted``."""
